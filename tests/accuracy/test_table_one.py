"""Table I of Lee, Ren and Huang (2008) on the loops that are public: CHEM10, 11, 12 are its loops 4, 5, 6.

The paper does not print its delays; 6 and 17 are those at which its numbers come out (reference methods.md,
section 0). OP has a span of 2 in all three.
"""

import pytest

from agent.analysis.quantify import quantifier
from agent.analysis.record.recording import LoopHints
from agent.analysis.record.window_of_recording import loop_window
from connectors.recording import read_recording

STEP = 0.02
"""One step of the grid: 1 % of the span of OP."""


def measure(recordings, name, method="lee2008", **hints):
    loop = read_recording(recordings / "isdb" / f"{name}.csv")
    found = quantifier(method).quantify(loop_window(loop, LoopHints(**hints)))
    return found, (found.stiction.f_s.value, found.stiction.f_d.value)


@pytest.mark.parametrize(
    ("name", "hints", "f_s", "f_d"),
    [
        ("CHEM10", {"delay": 6}, 1.70, 0.00),
        ("CHEM10", {"delay": 6, "order": 1}, 1.70, 0.00),
        ("CHEM10", {"delay": 6, "order": 2}, 1.70, 0.00),
        ("CHEM11", {"delay": 17}, 0.10, 0.04),
        ("CHEM11", {"delay": 17, "order": 1}, 0.10, 0.04),
        ("CHEM12", {}, 0.78, 0.64),
        ("CHEM12", {"order": 1}, 0.78, 0.64),
        ("CHEM12", {"order": 2}, 0.78, 0.64),
        ("CHEM12", {"delay": 1}, 0.78, 0.64),
        ("CHEM12", {"delay": 20, "order": 1}, 0.78, 0.64),
    ],
)
def test_the_grid_gives_the_printed_numbers(recordings, name, hints, f_s, f_d):
    _, found = measure(recordings, name, **hints)
    assert found == (pytest.approx(f_s, abs=0.001), pytest.approx(f_d, abs=0.001))


@pytest.mark.parametrize(("name", "f_s", "f_d"), [("CHEM10", 1.70, 0.00), ("CHEM11", 0.10, 0.04)])
def test_with_the_delay_searched_they_stay_near(recordings, name, f_s, f_d):
    _, found = measure(recordings, name)
    assert found == (pytest.approx(f_s, abs=0.10), pytest.approx(f_d, abs=0.10))


@pytest.mark.parametrize(
    ("name", "hints", "f_s", "f_d"),
    [("CHEM10", {"delay": 6}, 1.70, 0.00), ("CHEM11", {"delay": 17}, 0.10, 0.04), ("CHEM12", {}, 0.78, 0.64)],
)
def test_the_random_search_comes_near(recordings, name, hints, f_s, f_d):
    grid, _ = measure(recordings, name, **hints)
    random, found = measure(recordings, name, "lee2008_random", **hints)
    assert random.free_run_percent > grid.free_run_percent - 2
    assert found == (pytest.approx(f_s, abs=0.06), pytest.approx(f_d, abs=0.06))


@pytest.mark.parametrize(("name", "verdict"), [("CHEM10", "stiction"), ("CHEM12", "stiction")])
def test_the_sticking_loops_are_reported(recordings, name, verdict):
    assert measure(recordings, name)[0].decision == verdict
