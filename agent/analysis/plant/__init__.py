"""PLANT: loops that oscillate together, the root of each such group, and the path from it."""
