"""RECALL: windows that an agent kept, listed, and written as recordings."""
