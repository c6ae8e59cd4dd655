"""MQTT: subscribes to the topics of a loop, publishes its alarm as retained state and as events."""
