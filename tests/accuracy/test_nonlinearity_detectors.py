"""How often bicoherence, apparent stiction and surrogates are right on simulated loops.

These are the seeds that docs/methods tells of; the papers give no such counts.
"""

from collections import Counter
from functools import cache

import pytest

from agent.analysis.stiction.bicoherence import Bicoherence
from agent.analysis.stiction.choudhury_cmeans import ChoudhuryCmeans
from agent.analysis.stiction.choudhury_ellipse import LARGEST_MISFIT, ChoudhuryEllipse
from agent.analysis.stiction.thornhill_surrogates import ThornhillSurrogates
from tests.unit.stiction.loops import simulated

SEEDS = range(40)
FREE = ("none_noise", "tuning", "sinusoid", "drift")
STEADY = ("tuning", "sinusoid")

pytestmark = [pytest.mark.bench, pytest.mark.timeout(600)]


@cache
def results(detector, kind):
    return [detector.detect(*simulated(kind, seed)[:2]) for seed in SEEDS]


def verdicts(detector, kind):
    return Counter(each.verdict for each in results(detector, kind))


@pytest.mark.parametrize(
    "detector",
    [Bicoherence(), ChoudhuryEllipse(), ChoudhuryCmeans(), ThornhillSurrogates()],
    ids=lambda each: each.name,
)
def test_no_sticking_valve_is_called_sound_and_no_steady_loop_accused(detector):
    assert verdicts(detector, "stiction")["no_stiction"] == 0
    assert all(verdicts(detector, kind)["stiction"] == 0 for kind in STEADY)


def test_bicoherence_sees_what_has_periods_enough():
    seen = [each for each in results(Bicoherence(), "stiction") if each.seen is not None]
    assert len(seen) == 27
    assert sum(each.seen.nonlinear for each in seen) == 4
    free = [each.seen for kind in FREE for each in results(Bicoherence(), kind) if each.seen is not None]
    assert sum(each.nonlinear for each in free) <= 1


@pytest.mark.parametrize("detector", [ChoudhuryEllipse(), ChoudhuryCmeans()], ids=lambda each: each.name)
def test_apparent_stiction_is_called_in_those_four(detector):
    assert verdicts(detector, "stiction")["stiction"] == 4
    assert sum(verdicts(detector, kind)["stiction"] for kind in FREE) <= 1


def test_the_width_is_no_measure_of_s():
    found = results(ChoudhuryEllipse(), "stiction")
    called = {seed: each.seen.apparent for seed, each in enumerate(found) if each.verdict == "stiction"}
    valves = {seed: simulated("stiction", seed)[2].valve for seed in called}
    ratios = [called[seed] / (valve.f_s + valve.f_d) for seed, valve in valves.items()]
    assert min(ratios) == pytest.approx(0.3, abs=0.03)
    assert max(ratios) == pytest.approx(1.17, abs=0.05)


def test_ellipses_of_sticking_loops_fit():
    seen = [each.seen for each in results(ChoudhuryEllipse(), "stiction") if each.seen is not None]
    assert max(each.misfit for each in seen) < 0.2 < LARGEST_MISFIT


def test_surrogates_report_pure_sines_and_miss_most_valves():
    assert verdicts(ThornhillSurrogates(), "sinusoid")["no_stiction"] >= 26
    nonlinear = {
        kind: sum((each.index or 0.0) > 1 for each in results(ThornhillSurrogates(), kind))
        for kind in ("stiction", "sinusoid", "tuning")
    }
    assert nonlinear["stiction"] >= 3
    assert nonlinear["sinusoid"] <= 2
    assert nonlinear["tuning"] <= 1


def test_the_third_harmonic_is_absent_behind_no_sticking_valve():
    found = {
        kind: Counter(each.seen.harmonic for each in results(Bicoherence(), kind) if each.seen is not None)
        for kind in ("stiction", "sinusoid", "tuning")
    }
    assert found["stiction"]["absent"] == 0
    assert found["sinusoid"]["seen"] <= 2
    assert found["tuning"]["seen"] == 0
