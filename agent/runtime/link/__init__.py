"""ONE PEER: a connection's life, what waits to be published on it, what the peer refused."""
