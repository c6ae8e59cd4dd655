"""COMMISSIONING: find loops, read each tag once, judge whether its values are plausible."""
