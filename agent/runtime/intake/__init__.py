"""INTAKE: values of one loop in, one by one or many at once; clocks checked; windows out."""
