"""Buses and files: bytes become samples, publications become bytes. Nothing here knows what a loop is."""
