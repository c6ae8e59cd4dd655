"""Which words of a controller's mode mean that the loop was closed: a table that users extend.

Numbers: 0 and 1 as most systems write them; 2 and 3 are cascade and backup cascade of Honeywell's
controllers; 4 to 128 are the bits of MODE_BLK of Foundation Fieldbus (FF-891: Cas 4, Auto 8, Man 16,
LO 32, IMan 64, O/S 128), which DeltaV has as well.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

_AUTOMATIC = (
    "1 2 3 4 8 a au aut auto automat automatic automatica automatico automático automatique automatik "
    "automatisch automatisk авто автомат 自动 自動 "
    "b-cas bcas c cas casc cascada cascade cascata kas kask kaskade "
    "adv apc comp computer ddc dmc ext extern external mpc nor normal on prd prog program "
    "rc rcas rcasc rem-cas remote remote-cas rsp spc sup supervisory true"
)
"""Casefolded. Set points from a cascade, a program or a computer are automatic too: the loop is closed."""
_MANUAL = (
    "0 16 32 64 128 false h hand handbetrieb handmatig hnd iman init initman l-man lo local "
    "m man man. manu manual manuale manueel manuel manuell ruč руч ручной 手动 手動 "
    "o/s off oos out r-man rman ro rout shutdown track tracking trk"
)
"""Casefolded. OP is moved by a person, follows another signal, or is not used."""
KNOWN: Mapping[str, bool] = dict.fromkeys(_AUTOMATIC.split(), True) | dict.fromkeys(_MANUAL.split(), False)
"""Word -> whether it means automatic."""
NO_OTHERS: Mapping[str, bool] = {}
CUT_BY = " :/"
"""Characters behind the first word of a mode such as ``AUTO/NORMAL`` or ``CAS (2)``."""


def word_of(mode: float | str) -> str:
    """Return a mode as the table has it: casefolded, a number without its zeros; empty for none."""
    if isinstance(mode, str):
        text = mode.strip().casefold()
        try:
            mode = float(text)
        except ValueError:
            return text
    return "" if mode != mode else f"{mode:g}"  # noqa: PLR0124 - NaN


def is_automatic(mode: float | str, others: Mapping[str, bool] = NO_OTHERS) -> bool | None:
    """Return whether a mode means automatic; None where the table does not have it.

    Args:
        mode: As recorded.
        others: Words (``word_of``) that come before those of the table.
    """
    word = word_of(mode)
    found = others.get(word, KNOWN.get(word))
    if found is not None or not word:
        return found
    return KNOWN.get(_first_part(word))


def automatic_share(modes: Sequence[str], others: Mapping[str, bool] = NO_OTHERS) -> FloatArray:
    """Return 1 where the mode is automatic, 0 where it is not and NaN where none was recorded, shape (n,).

    A mode that neither table has is not automatic: what OP does in it is not known.
    """
    meaning = {mode: _number(mode, others) for mode in set(modes)}
    return np.array([meaning[mode] for mode in modes], np.float64)


def unknown_modes(modes: Iterable[str], others: Mapping[str, bool] = NO_OTHERS) -> tuple[str, ...]:
    """Return the modes that neither table has, each once, sorted."""
    words = {mode for mode in modes if word_of(mode)}
    return tuple(sorted(mode for mode in words if is_automatic(mode, others) is None))


def _number(mode: str, others: Mapping[str, bool]) -> float:
    return np.nan if not word_of(mode) else float(is_automatic(mode, others) or False)


def _first_part(word: str) -> str:
    """Return what stands before the first character of ``CUT_BY``; ``o/s`` has been looked up whole."""
    ends = [word.index(mark) for mark in CUT_BY if mark in word]
    return word[: min(ends)] if ends else word
