"""Candidates of one group, each in a lane: their valves, their processes, and the steps to better ones."""
