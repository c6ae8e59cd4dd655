"""FORWARD: what a valve and a process do. Arrays in, arrays out; no clock, no files."""
