"""Searches over the bounded space of valves, and what their fits share."""
