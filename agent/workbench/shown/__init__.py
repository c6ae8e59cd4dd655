"""What a record can show of each effect: how OP excites it, and how plainly the predictions would show it."""
