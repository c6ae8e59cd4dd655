"""Process models behind a valve: least squares, ARMAX, output error."""
