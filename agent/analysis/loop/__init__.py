"""THE LOOP: what OP and PV say of controller, delay and apparent stiction."""
