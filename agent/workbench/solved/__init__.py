"""Numbers of a model that are solved for, not searched: gain, heights, amplitude, phase, with intervals."""
