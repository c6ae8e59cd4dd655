"""RECALL: windows and raw samples that an agent kept, written as recordings."""
