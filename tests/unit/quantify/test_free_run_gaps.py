"""``free_run`` where samples are missing: the verdict and S stay."""

from dataclasses import replace

import numpy as np
import pytest

from tests.unit.quantify.shipped_plants import FREE_RUN, SAMPLES, plant, true_s


def with_gaps(window, length, which="both"):
    """A tenth is missing, in blocks."""
    op, pv = window.op.copy(), window.pv.copy()
    for start in range(2 * length, SAMPLES, 10 * length):
        if which in ("op", "both"):
            op[start : start + length] = np.nan
        if which in ("pv", "both"):
            pv[start : start + length] = np.nan
    return replace(window, op=op, pv=pv)


ONE_OF_EACH = [
    pytest.param("fic101_stick_slip", marks=pytest.mark.bench),
    pytest.param("tic302_second_order", marks=pytest.mark.bench),
    "pic402_sinusoid",
    "fic103_healthy",
]
"""With gaps a sticking valve is sought for 4 to 10 s; one of them, with one gap, stays in `make test`."""


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_short_gaps_do_not_change_the_verdict(name):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 5)).decision == scenario.truth.verdict


@pytest.mark.parametrize("name", ONE_OF_EACH)
def test_long_gaps_may_leave_it_open_but_never_turn_it(name):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 20)).decision in {scenario.truth.verdict, "undecided"}


@pytest.mark.parametrize("name", ["pic401_direct_stick_slip", "fic104_tight_tuning"])
@pytest.mark.parametrize("which", ["op", "pv"])
def test_nor_do_long_gaps_in_one_of_the_two(name, which):
    scenario, window = plant(name)
    assert FREE_RUN.quantify(with_gaps(window, 20, which)).decision in {
        scenario.truth.verdict,
        "undecided",
    }


@pytest.mark.parametrize(
    ("start", "which"),
    [
        (900, "pv"),
        pytest.param(300, "both", marks=pytest.mark.bench),
        pytest.param(300, "pv", marks=pytest.mark.bench),
        pytest.param(900, "both", marks=pytest.mark.bench),
    ],
)
def test_one_gap_leaves_s_as_it_is(start, which):
    _, window = plant("fic101_stick_slip")
    op, pv = window.op.copy(), window.pv.copy()
    pv[start : start + 20] = np.nan
    if which == "both":
        op[start : start + 20] = np.nan
    found = FREE_RUN.quantify(replace(window, op=op, pv=pv))
    assert found.decision == "stiction"
    assert found.stiction.s.value == pytest.approx(true_s("fic101_stick_slip"), abs=0.02 * window.op_span)
