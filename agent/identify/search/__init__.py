"""THE SEARCH: one population of valves over a growing record, each with the process that its path implies."""
