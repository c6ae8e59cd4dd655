"""Screens: one module here and one of the same name in ``static/screens``."""

from agent.web.screens.screen import PageScreen

__all__ = ["PageScreen"]
