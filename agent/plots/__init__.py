"""Pictures for an engineer; figures of matplotlib, no files."""
