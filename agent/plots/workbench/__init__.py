"""Pictures of the workbench, one a file, each from values alone."""
