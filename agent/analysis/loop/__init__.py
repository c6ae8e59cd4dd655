"""THE LOOP: controller, delay and apparent stiction, estimated from OP and PV."""
