"""Modbus TCP: polls the registers of a loop in one request, writes its alarm to coils and registers."""
