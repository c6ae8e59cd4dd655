"""SURVEY: the command, its progress and its results as files."""
