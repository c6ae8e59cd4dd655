"""ON DISK: alarms and outboxes that survive a crash, the history, one agent a file."""
