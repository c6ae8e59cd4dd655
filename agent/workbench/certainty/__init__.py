"""How sure the numbers of a fitted model are."""
