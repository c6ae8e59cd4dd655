"""Distinguishes a node that stays the same from one that its server has forgotten to report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from asyncua import ua

GONE = (ua.StatusCodes.BadNodeIdUnknown, ua.StatusCodes.BadNodeIdInvalid)
"""What a server says of a node that is not there any more."""
DIFFERENT = 2
"""Looks in a row that must find another value than was reported."""
MOST = 3
"""Times that a node is watched anew in one session: some servers never report what a read returns."""


class Silence:
    """Nodes that are watched, and which of them were silent between two looks.

    A subscription reports changes only, so silence means nothing by itself. But some servers drop what
    they watch where a node was deleted and made again, as after a download to a controller. Reading the
    silent ones now and then shows it: the node is gone, or has another value than was reported.
    """

    def __init__(self) -> None:
        self._told: dict[str, object] = {}
        """Newest value of each node that is watched."""
        self._heard: set[str] = set()
        """Nodes that were reported since the last look."""
        self._different: Counter[str] = Counter()
        """Looks in a row that found another value."""
        self._renewed: Counter[str] = Counter()

    def watch(self, node: str) -> None:
        """The server accepted this node."""
        self._told[node] = None
        self._heard.add(node)
        del self._different[node]

    def told(self, nodes: Sequence[str], values: Iterable[object]) -> None:
        """It reported these values."""
        self._told.update(zip(nodes, values, strict=True))
        self._heard.update(nodes)

    def silent(self) -> list[str]:
        """Return what was not reported since the last call."""
        for node in self._heard & self._different.keys():
            del self._different[node]
        silent = [node for node in self._told if node not in self._heard]
        self._heard.clear()
        return silent

    def is_lost(self, node: str, read: ua.DataValue) -> bool:
        """Return whether a silent node that reads so must be watched anew; it is forgotten then."""
        status = read.StatusCode or ua.StatusCode()
        if status.value not in GONE:
            if node in self._heard or _same(_value(read), self._told[node]):
                del self._different[node]
                return False
            self._different[node] += 1
            if self._different[node] < DIFFERENT or self._renewed[node] == MOST:
                return False
            self._renewed[node] += 1
        del self._told[node], self._different[node]
        self._heard.discard(node)
        return True


def _value(data: ua.DataValue) -> object:
    return None if data.Value is None else data.Value.Value


def _same(one: object, other: object) -> bool:
    return one == other or (one != one and other != other)  # NaN  # noqa: PLR0124
