"""PARTS: one finding of a diagnosis each, in words and as JSON."""
