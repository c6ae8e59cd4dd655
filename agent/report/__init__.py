"""RESULTS FOR READERS: diagnosis and comparison as JSON, text, reasons and advice."""
