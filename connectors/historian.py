"""Words a historian writes where a number belongs, when it had no number to write."""

from __future__ import annotations

GAP_WORDS = frozenset(
    {
        "",
        "-",
        "--",
        "---",
        "#n/a",
        "access denied",
        "arc off-line",
        "bad",
        "bad data",
        "bad input",
        "bad output",
        "bad quality",
        "bad sample",
        "bad value",
        "calc failed",
        "calc off",
        "comm error",
        "comm fail",
        "configure",
        "device failure",
        "doubtful",
        "equip fail",
        "error",
        "failed",
        "i/o timeout",
        "inp out of range",
        "intf shut",
        "invalid",
        "invalid data",
        "invalid float",
        "io timeout",
        "missing",
        "n/a",
        "na",
        "nil",
        "no data",
        "no good data",
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
        "shutdown",
        "under range",
        "unit down",
        "unknown",
    }
)
"""Lower case. PI digital states and the words of other exports. ``NaN`` is a number already."""


def is_gap(cell: str) -> bool:
    """Return whether ``cell`` says that there is no value."""
    return cell.strip().strip("<>").casefold() in GAP_WORDS
