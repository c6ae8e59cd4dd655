"""A Modbus TCP server of our own: control systems read the alarms from it, and may acknowledge them."""
