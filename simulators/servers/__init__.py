"""Servers that put simulated or recorded loops on a bus."""
