"""WEAR: S of a valve against time, its jumps down at repairs, its slope, and when it reaches a limit."""
