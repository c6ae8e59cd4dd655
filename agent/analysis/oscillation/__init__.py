"""Oscillation detectors, one a file."""
