"""Parts of a plant that are seldom linear: pipe, transmitter, hot vessel, drive."""
