"""BROWSE: what the command looks at, and what it shows and writes."""
