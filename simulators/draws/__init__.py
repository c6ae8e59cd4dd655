"""Random plants: loops, moves, loads and hidden effects, drawn by a seed."""
