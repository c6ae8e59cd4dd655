"""Stiction quantifiers, one a file."""

from __future__ import annotations

from agent.analysis.quantify.choudhury2008 import Choudhury2008
from agent.analysis.quantify.free_run import FreeRun
from agent.analysis.quantify.jelali2008 import Jelali2008
from agent.analysis.quantify.karra_karim2009 import KarraKarim2009
from agent.analysis.quantify.lee2008 import Lee2008
from agent.analysis.quantify.quantifier import Quantifier
from agent.analysis.quantify.srinivasan2005 import Srinivasan2005
from agent.analysis.quantify.stenman2003 import Stenman2003Quantifier

__all__ = ["QUANTIFIERS", "Quantifier", "quantifier"]

QUANTIFIERS: tuple[Quantifier, ...] = (
    FreeRun(),
    Lee2008("grid"),
    Lee2008("random"),
    Choudhury2008(),
    Jelali2008("genetic"),
    Jelali2008("pattern"),
    Srinivasan2005(),
    Stenman2003Quantifier(),
    KarraKarim2009(),
)


def quantifier(name: str) -> Quantifier:
    """Return the quantifier of that name.

    Raises:
        ValueError: There is none; the message lists those there are.
    """
    for candidate in QUANTIFIERS:
        if candidate.name == name:
            return candidate
    raise ValueError(f"no quantifier {name!r}; there are {', '.join(each.name for each in QUANTIFIERS)}")
