"""DESIGN: the next test at a loop, computed from two fitted models that its record cannot distinguish."""
