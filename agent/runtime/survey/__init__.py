"""SURVEY: an archive of loops diagnosed on many cores or machines, resumed where it was interrupted."""
