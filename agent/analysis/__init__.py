"""INVERSE: what the data say about a loop. Pure functions of recorded windows."""
