"""The alarm as OPC UA Part 9 has it: condition, events, methods, filters."""
