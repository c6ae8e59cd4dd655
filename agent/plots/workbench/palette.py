"""Colours of models and of what goes with them."""

from __future__ import annotations

from agent.plots.axes import MODEL, VALVE

COLOURS = (MODEL, VALVE, "#7b4fa3", "#c99700", "#2f7fc1", "#b0457b", "#5f6b2d", "#4d4d4d")
"""Of models and effects, in their order; more than these are drawn in the same again."""
BAND = "#dfe5ea"
HELD_OUT = "#f3f5f7"
FAILS = MODEL
