"""Distinguishes a node that stays the same from one that its server has forgotten to report."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

from asyncua import ua

GONE = (ua.StatusCodes.BadNodeIdUnknown, ua.StatusCodes.BadNodeIdInvalid)
"""What a server says of a node that is not there any more."""
DIFFERENT = 2
"""Looks in a row that must find another value than was reported."""
MOST = 3
"""Times that a node is watched anew in one session: some servers never report what a read returns."""


@dataclass(slots=True)
class _Node:
    told: object = None
    """Its newest value."""
    heard: bool = True
    """Whether it was reported since the last look."""
    different: int = 0
    """Looks in a row that found another value."""


class Silence:
    """Nodes that are watched, and which of them were silent between two looks.

    A subscription reports changes only, so silence means nothing by itself. But some servers drop what
    they watch where a node was deleted and made again, as after a download to a controller. Reading the
    silent ones now and then shows it: the node is gone, or has another value than was reported.
    """

    def __init__(self) -> None:
        self._nodes: dict[str, _Node] = {}
        self._renewed: Counter[str] = Counter()

    def watch(self, node: str) -> None:
        """The server accepted this node."""
        self._nodes[node] = _Node()

    def told(self, node: str, value: object) -> None:
        """It reported this value."""
        known = self._nodes.get(node)
        if known is None:
            known = self._nodes[node] = _Node()
        known.told, known.heard, known.different = value, True, 0

    def silent(self) -> list[str]:
        """Return what was not reported since the last call."""
        silent = [node for node, known in self._nodes.items() if not known.heard]
        for known in self._nodes.values():
            known.heard = False
        return silent

    def is_lost(self, node: str, read: ua.DataValue) -> bool:
        """Return whether a silent node that reads so must be watched anew; it is forgotten then."""
        known = self._nodes[node]
        status = read.StatusCode or ua.StatusCode()
        if status.value not in GONE:
            told = known.heard or _same(_value(read), known.told)
            known.different = 0 if told else known.different + 1
            if known.different < DIFFERENT or self._renewed[node] == MOST:
                return False
            self._renewed[node] += 1
        del self._nodes[node]
        return True


def _value(data: ua.DataValue) -> object:
    return None if data.Value is None else data.Value.Value


def _same(one: object, other: object) -> bool:
    return one == other or (one != one and other != other)  # NaN  # noqa: PLR0124
