"""Sparkplug B 3.0: an edge node on an MQTT broker whose devices are the loops."""
