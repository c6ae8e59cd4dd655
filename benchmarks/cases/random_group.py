"""Simulated recordings of one valve, as the diagnosis gets them, with the truth of the valve."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from agent.analysis.record.recording import LoopWindow
from benchmarks.cases.random_loop import STICKING, AnyKind, random_scenario, window_of
from simulators.draws.other_recordings import recordings_of, with_something_unknown
from simulators.plant import simulate

GROUP_KINDS: tuple[AnyKind, ...] = (
    "flow",
    "set_point",
    "drift",
    "one_way",
    "cascade",
    "flow_stiction",
    "one_way_stiction",
    "cascade_stiction",
)
"""Those that are hard to judge alone; limit cycles and ``set_point_stiction`` are not, and cost the most."""


@dataclass(frozen=True, slots=True)
class RandomGroup:
    """Recordings of one valve."""

    kind: AnyKind
    seed: int
    windows: tuple[LoopWindow, ...]

    @property
    def sticks(self) -> bool:
        return self.kind in STICKING


def random_group(kind: AnyKind, seed: int, count: int) -> RandomGroup:
    """Draw a loop and simulate ``count`` recordings of it; the same seed gives the same loop.

    A sticking valve shows its friction in the recording it was drawn with, not in every one.
    """
    rng = np.random.default_rng([seed, *kind.encode()])
    while True:
        scenario, _ = random_scenario(kind, int(rng.integers(2**31)))
        loop = with_something_unknown(scenario, rng) if rng.random() < 0.5 else scenario
        recordings = recordings_of(loop, rng, count, one_way=kind.startswith("one_way"))
        if recordings is not None:
            return RandomGroup(kind, seed, tuple(window_of(each, simulate(each)) for each in recordings))
