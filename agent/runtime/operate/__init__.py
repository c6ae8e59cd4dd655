"""OPERATION: orders of people, health, metrics, a changed configuration, systemd, the watchdog."""
