"""The fault that a gate reports, and the methods that it closes."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import get_args

from agent.analysis.results import MethodKind

ALL_KINDS: frozenset[MethodKind] = frozenset(get_args(MethodKind))
SHAPE: frozenset[MethodKind] = frozenset({"limit_cycle", "travel"})
"""Methods that look at the shape of the signals, sample by sample."""
LIMIT_CYCLE: frozenset[MethodKind] = frozenset({"limit_cycle"})
"""Methods that need a steady oscillation."""


@dataclass(frozen=True, slots=True)
class GateFault:
    """A fault of the record that forbids a verdict to some methods."""

    name: str
    """Stable word; docs/methods/gates.md lists them."""
    reason: str
    """The same for an engineer."""
    closes: frozenset[MethodKind] = ALL_KINDS
    """Kinds of methods that give no verdict on such a record."""


def closed_kinds(faults: Iterable[GateFault]) -> frozenset[MethodKind]:
    """Return the kinds of methods that the faults close; with all of them closed there is no verdict."""
    return frozenset[MethodKind]().union(*(fault.closes for fault in faults))
