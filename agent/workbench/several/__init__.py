"""SEVERAL RECORDINGS: one model over all, what belongs to a recording its own; held out by recording."""
