"""The address space: nodes of the agent and of each loop."""
