"""Stiction laws of the literature, one published model a file."""

from __future__ import annotations

from agent.physics.valves.choudhury2005 import Choudhury2005
from agent.physics.valves.damped_stem import DampedStem
from agent.physics.valves.he2007 import He2007
from agent.physics.valves.he_wang2014 import HeWang2014
from agent.physics.valves.kano2004 import Kano2004
from agent.physics.valves.law import StictionLaw
from agent.physics.valves.stenman2003 import Stenman2003
from agent.physics.valves.two_state import TwoState

__all__ = ["LAWS", "StictionLaw", "law"]

LAWS: tuple[StictionLaw, ...] = (
    He2007(),
    Kano2004(),
    Choudhury2005(),
    TwoState(),
    DampedStem(),
    Stenman2003(),
    HeWang2014(),
)


def law(name: str) -> StictionLaw:
    """Return the law of that name.

    Raises:
        ValueError: There is none; the message lists the known names.
    """
    for candidate in LAWS:
        if candidate.name == name:
            return candidate
    raise ValueError(f"no stiction law {name!r}; there are {', '.join(each.name for each in LAWS)}")
