"""RESPONSE: whether PV responds to OP at all, and why not."""
