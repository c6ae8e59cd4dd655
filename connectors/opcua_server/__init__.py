"""OPC UA server of our own: each loop an object, its alarm a condition that people can acknowledge."""
