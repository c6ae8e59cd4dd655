"""RAW SAMPLES: as they came, a minute of a loop in one row, through a file on this machine to a database."""
