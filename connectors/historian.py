"""Words a historian writes where a number belongs, when it had no number to write."""

from __future__ import annotations

import re

NUMBER_OF_ERROR = re.compile(r"^\[-?\d+\]\s*")
"""PI DataLink writes ``[-11059] No Good Data For Calculation``."""
GAP_WORDS = frozenset(
    {
        "#div/0!",
        "#n/a",
        "#n/a n/a",
        "#name?",
        "#null!",
        "#num!",
        "#ref!",
        "#value!",
        "-1.#ind",
        "-nan(ind)",
        "1.#ind",
        "1.#qnan",
        "access denied",
        "arc off-line",
        "calc crash",
        "calc failed",
        "calc off",
        "calc overflow",
        "calc timeout",
        "coercion failed",
        "comm error",
        "comm fail",
        "configure",
        "creating",
        "dcs failed",
        "device failure",
        "doubtful",
        "equip fail",
        "err",
        "error",
        "failed",
        "filter fail",
        "i/o timeout",
        "inp out of range",
        "inp outrange",
        "intf shut",
        "invalid",
        "invalid data",
        "invalid float",
        "io timeout",
        "missing",
        "n/a",
        "na",
        "nan(ind)",
        "nil",
        "no data",
        "no good data",
        "no good data for calculation",
        "no lab data",
        "no output",
        "no result",
        "no sample",
        "no value",
        "no_data",
        "nodata",
        "none",
        "not available",
        "not connect",
        "not connected",
        "null",
        "out of range",
        "out of serv",
        "out of service",
        "over range",
        "pt created",
        "scan off",
        "scan timeout",
        "set to bad",
        "setup",
        "shutdown",
        "stale",
        "trace",
        "trace error",
        "under range",
        "unit down",
        "unknown",
    }
)
"""Lower case. PI digital states and the words of other exports. ``NaN`` is a number already."""


def is_gap(cell: str) -> bool:
    """Return whether ``cell`` says that there is no value: a known word, Bad..., or signs alone."""
    word = NUMBER_OF_ERROR.sub("", cell.strip()).strip("<>").casefold()
    return word in GAP_WORDS or word.startswith("bad") or not any(map(str.isalnum, word))
