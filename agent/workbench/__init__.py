"""COMPARE: where a model of a loop fails, which physical effect is missing, and by how much the error falls.

Pure: values in, values out; a map function and a progress callback are handed in.
"""
