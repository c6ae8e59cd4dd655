"""IDENTIFY: valve and process estimated together from OP and PV, by one search. Pure; arrays in, arrays out."""
