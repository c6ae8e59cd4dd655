"""Figures for an engineer, as matplotlib objects; no files."""
