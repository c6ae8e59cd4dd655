"""THE RESIDUAL: where a model fails, on which axis, and how far the error could fall."""
