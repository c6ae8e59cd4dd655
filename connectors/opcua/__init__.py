"""OPC UA: subscribes to the nodes of a loop, writes its alarm to nodes."""
