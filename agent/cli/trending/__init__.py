"""TREND: S against time from the history of an agent, printed and drawn."""
