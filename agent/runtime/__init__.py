"""TIME AND I/O: windows, pipeline, workers, supervision, wiring."""
