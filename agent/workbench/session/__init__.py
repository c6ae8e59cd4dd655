"""A SESSION with one recording: open it, compare, add, drop, undo, go on by itself, sum up."""

from __future__ import annotations

from agent.workbench.session.workbench import Workbench

__all__ = ["Workbench"]
