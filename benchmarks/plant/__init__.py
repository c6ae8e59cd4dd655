"""A PLANT of many loops: its broker, what publishes its values, and what reads them, each a process."""
