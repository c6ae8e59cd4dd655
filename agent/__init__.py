"""slipjump: finds sticking control valves from controller output and process variable."""

__version__ = "0.1.0"
