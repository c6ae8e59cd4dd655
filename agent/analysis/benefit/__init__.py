"""BENEFIT: what a repair, or another tuning, would gain, from the fitted loop."""
