"""Roles by the letters of instruments: ``FT-211`` measures what the valve ``FV-211`` moves, in loop F-211.

The first letters are the variable, those behind them what the instrument does: T transmits, I indicates, V
and CV are the valve. Source: ANSI/ISA-5.1-2009, Instrumentation Symbols and Identification, table 4.1.
"""

from __future__ import annotations

import re

from connectors.exports.cells.tag_roles import SERVER, UNIT, TagRole

INSTRUMENT = re.compile(
    r"(?P<area>(?:.*[\W_])?\d{0,4})(?P<variable>[A-Z][DFKQ]?)(?P<function>I?T|I|C?V)[\W_]?(?P<number>\d{2,}[A-Z]?)",
    re.IGNORECASE,
)
"""Area, letters and number: ``FT_211``, ``11-PDIT-1104A``, ``TCV101``."""


def instrument_role(name: str) -> TagRole | None:
    """Return loop and role of the tag of an instrument; None where it is of no transmitter and no valve.

    A valve is ``mv``: such a column holds what the controller sent to it, or where it stands.
    """
    found = INSTRUMENT.fullmatch(SERVER.sub("", UNIT.sub("", name)).strip())
    if found is None:
        return None
    role = "mv" if found["function"].upper().endswith("V") else "pv"
    loop = f"{found['area']}{found['variable']}-{found['number']}".upper()
    return TagRole(loop, role, word=found["function"].casefold())
