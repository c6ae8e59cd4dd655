"""What a screen is made of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from fastapi import APIRouter


@dataclass(frozen=True, slots=True)
class PageScreen:
    """One screen of the page: its address, and the REST interface that it draws."""

    name: str
    """Of its module here and in ``static/screens``."""
    title: str
    """In the navigation; empty: it is reached from another screen."""
    path: str
    """Address in the browser, e.g. ``/loops/{name}``."""
    router: APIRouter
    """Its REST interface, all of it under ``/api``."""
    uploads: Mapping[str, int] = field(default_factory=dict)
    """Path of a route -> largest body that it takes, bytes, where that is more than usual."""
