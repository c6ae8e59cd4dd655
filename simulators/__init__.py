"""Plants with known faults, and servers that put them on a bus. Only they know the truth of a fault."""
