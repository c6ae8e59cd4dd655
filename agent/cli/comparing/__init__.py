"""COMPARE: what the command shares with its conversation on a terminal, whose session is kept and resumed."""
