"""What `make bench` runs: how often and how well slipjump is right, and how long it takes."""
