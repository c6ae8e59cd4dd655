"""Stiction laws of the literature, one published model a file."""
