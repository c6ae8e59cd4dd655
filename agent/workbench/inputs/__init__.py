"""Measured inputs beside OP, a feed or a second actuator, as effects that a record may confirm."""
