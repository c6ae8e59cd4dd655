"""How often the detectors of Horch, Singhal and Salsbury, Kano and Yamashita are right on simulated loops.

These are the seeds that docs/methods tells of, and the limits that no paper gives were fixed on them.
"""

from collections import Counter
from dataclasses import replace
from functools import cache

import pytest

from agent.analysis.stiction.horch_ccf import HorchCcf
from agent.analysis.stiction.horch_histogram import HorchHistogram
from agent.analysis.stiction.kano_a import KanoA
from agent.analysis.stiction.kano_b import KanoB
from agent.analysis.stiction.singhal_salsbury import SinghalSalsbury
from agent.analysis.stiction.yamashita import Yamashita
from tests.unit.stiction.loops import simulated

SEEDS = range(40)
FREE = ("none_noise", "tuning", "sinusoid", "drift")


@cache
def verdicts(detector, kind, *, with_mv=True):
    """How often the detector says what of a kind of loop."""
    said = Counter()
    for seed in SEEDS:
        window, oscillation, _ = simulated(kind, seed)
        said[detector.detect(window if with_mv else replace(window, mv=None), oscillation).verdict] += 1
    return said


@pytest.mark.bench
@pytest.mark.timeout(600)
@pytest.mark.parametrize("detector", [KanoA(), KanoB(), Yamashita()], ids=lambda each: each.name)
def test_a_measured_stem_reports(detector):
    assert verdicts(detector, "stiction") == {"stiction": 40}
    assert sum(verdicts(detector, kind)["stiction"] for kind in FREE) == 0


@pytest.mark.bench
@pytest.mark.timeout(600)
@pytest.mark.parametrize("detector", [KanoB(), Yamashita()], ids=lambda each: each.name)
def test_pv_stands_for_the_stem_in_a_quarter_of_the_sticking_loops_and_in_no_other(detector):
    assert verdicts(detector, "stiction", with_mv=False)["stiction"] >= 10
    assert all(verdicts(detector, kind, with_mv=False) == {"not_applicable": 40} for kind in FREE)


@pytest.mark.bench
@pytest.mark.timeout(600)
@pytest.mark.parametrize(
    ("detector", "seen", "denied", "accused"),
    [(HorchCcf(), 11, 3, 9), (HorchHistogram(), 24, 12, 2), (SinghalSalsbury(), 22, 0, 3)],
    ids=lambda each: getattr(each, "name", None),
)
def test_shapes(detector, seen, denied, accused):
    """Of 40 sticking loops seen and denied; of 160 others accused."""
    sticking = verdicts(detector, "stiction")
    assert sticking["stiction"] >= seen
    assert sticking["no_stiction"] <= denied
    assert sum(verdicts(detector, kind)["stiction"] for kind in FREE) <= accused
