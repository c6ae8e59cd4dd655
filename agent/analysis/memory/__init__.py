"""MEMORY: what all windows of one valve say together, as a small state that each window updates."""
