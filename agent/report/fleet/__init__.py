"""FLEET: many recordings as one list of valves, as table, CSV and page."""
