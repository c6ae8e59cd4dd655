"""Low-order processes between valve and PV, one a file."""
