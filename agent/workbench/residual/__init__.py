"""THE RESIDUAL: where a model fails, on which axis, and how far its error can fall."""
