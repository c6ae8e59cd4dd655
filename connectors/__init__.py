"""Buses and files: bytes become samples, publications become bytes. Nothing here knows what a loop is.

The buses are registered in ``connectors.kinds`` and not here, so that reading a file loads no bus library.
"""
