"""Adequacy checks of a hypothesis that would be confirmed: what speaks against it, or what it lacks."""
