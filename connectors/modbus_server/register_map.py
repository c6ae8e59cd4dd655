"""Where everything is: the header, then a block for each loop, in the order of the configuration.

All registers are both holding and input registers; the bits of a loop's status word are discrete inputs too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from connectors.base import Action

VERSION = 1
"""Of this map; it rises when something goes or changes its place or meaning."""
BLOCK = 20
"""Registers of the header, and of each loop."""
BITS = 16
"""Discrete inputs of each loop."""
MOST_LOOPS = 65536 // BLOCK - 1

HEARTBEAT, ACTIVE_LOOPS, TIME = 1, 5, 6
STATUS, STATE, NE107, VERDICT, PRIORITY, QUALITY = 0, 1, 2, 3, 4, 5
NUMBERS = {"s": 6, "j": 8, "f_s": 10, "f_d": 12}
"""Field -> offset of its float32."""
TOLD, UNTIL = 14, 16
ORDER, MINUTES = 18, 19

STATES = ("normal", "unacked_active", "acked_active", "returned_unacked", "shelved", "out_of_service")
VERDICTS = ("", "stiction", "no_stiction", "undecided", "not_testable")
PRIORITIES = ("", "low", "medium", "high", "critical")
ORDERS: dict[int, Action] = {
    1: "acknowledge",
    2: "shelve",
    3: "unshelve",
    4: "out_of_service",
    5: "in_service",
}
SHELVING = 480
"""Minutes in a loop's register before somebody writes others."""

STATUS_BITS = (
    "alarm is active",
    "alarm is active and acknowledged",
    "alarm is shelved",
    "alarm is out of service",
    "alarm is gone and was never acknowledged",
    "",
    "",
    "",
    "NE 107 failure",
    "NE 107 function check",
    "NE 107 out of specification",
    "NE 107 maintenance required",
    "",
    "",
    "",
    "known: something was published of this loop since the agent started",
)
"""Meaning of the bits of a status word, the lowest first; an empty one is always 0."""


@dataclass(frozen=True, slots=True)
class Place:
    """One thing on the map."""

    table: Literal["register", "discrete input", "coil"]
    """A register is in both tables, input and holding."""
    address: int
    """As on the wire, from 0."""
    type: Literal["bit", "uint16", "uint32", "float32"]
    loop: str
    """Empty for the header."""
    meaning: str
    writable: bool = False
    """Where orders are taken; writable registers are holding registers."""


def block(index: int) -> int:
    """Return the first register of the loop of this index, from 0."""
    return BLOCK * (index + 1)


def places(loops: Sequence[str]) -> Iterator[Place]:
    """Yield all places of a map of these loops, table after table."""
    header = (
        (0, "uint16", f"version of this map, {VERSION}"),
        (
            HEARTBEAT,
            "uint16",
            "heartbeat: rises by 1 every second while the agent works, 65535 is followed by 0",
        ),
        (2, "uint16", "number of loops"),
        (3, "uint16", "registers of a loop"),
        (4, "uint16", "first register of the first loop"),
        (ACTIVE_LOOPS, "uint16", "loops whose alarm is active"),
        (TIME, "uint32", "time of the agent, s since 1970 UTC"),
    )
    for offset, type_, meaning in header:
        yield Place("register", offset, type_, "", meaning)  # type: ignore[arg-type]
    for index, loop in enumerate(loops):
        for offset, type_, meaning in _LOOP:
            writable = offset in (ORDER, MINUTES)
            yield Place("register", block(index) + offset, type_, loop, meaning, writable)  # type: ignore[arg-type]
    for index, loop in enumerate(loops):
        for bit, meaning in enumerate(STATUS_BITS):
            if meaning:
                yield Place("discrete input", BITS * index + bit, "bit", loop, meaning)
    for index, loop in enumerate(loops):
        yield Place(
            "coil", index, "bit", loop, "acknowledge: write 1, reads 0 again when it is taken", writable=True
        )


def _numbered(names: Sequence[str]) -> str:
    return ", ".join(f"{number} {name or 'not known'}" for number, name in enumerate(names))


_LOOP = (
    (STATUS, "uint16", "status word; its bits are the discrete inputs"),
    (STATE, "uint16", f"state of the alarm: {_numbered(STATES)}"),
    (
        NE107,
        "uint16",
        "NE 107: 0 normal, 1 failure, 2 function check, 3 out of specification, 4 maintenance required",
    ),
    (VERDICT, "uint16", f"verdict of the newest window: {_numbered(VERDICTS)}"),
    (PRIORITY, "uint16", f"priority: {_numbered(PRIORITIES)}"),
    (QUALITY, "uint16", "quality of the four numbers: 0 good, 1 of an earlier window, 2 not known (NaN)"),
    (NUMBERS["s"], "float32", "S, width of the stick band, OP units"),
    (NUMBERS["j"], "float32", "J, slip jump, OP units"),
    (NUMBERS["f_s"], "float32", "f_S, OP units"),
    (NUMBERS["f_d"], "float32", "f_D, OP units"),
    (
        TOLD,
        "uint32",
        "end of the newest window, or time of the newest decision, s since 1970 UTC; 0 not known",
    ),
    (UNTIL, "uint32", "end of shelving, s since 1970 UTC; 0 none"),
    (
        ORDER,
        "uint16",
        "order: 1 acknowledge, 2 shelve, 3 unshelve, 4 out of service, 5 in service; 0 when it is taken",
    ),
    (MINUTES, "uint16", f"minutes that order 2 shelves for, {SHELVING} unless written"),
)
