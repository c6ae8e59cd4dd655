"""PEERS of other makers: aedes, node-opcua and libmodbus, and what an agent makes of their habits."""
