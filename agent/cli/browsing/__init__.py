"""What ``slipjump browse`` looks at, and what it shows and writes."""
