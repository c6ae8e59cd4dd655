"""WORKBENCH ON THE PAGE: sessions, each in a process of its own, and what a browser gets of them."""
