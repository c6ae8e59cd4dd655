"""Loads as series of samples: waves and steps."""
