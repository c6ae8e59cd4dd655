"""What cells mean: times, numbers, qualities, tags and their roles."""
