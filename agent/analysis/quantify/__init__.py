"""Stiction quantifiers, one a file."""
