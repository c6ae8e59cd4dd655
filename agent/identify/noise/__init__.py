"""The noise of a record: what is new in it at each sample."""
