"""Plants with known faults, and servers that put them on a bus. Truth that the identifier does not have."""
