"""IDENTIFY: valve and process estimated together from OP and PV. Pure; arrays in, arrays out."""
