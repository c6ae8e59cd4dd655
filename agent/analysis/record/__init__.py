"""THE RECORD: one loop on a uniform time grid, its gaps, mode, reversals and events."""
