"""Horch's correlation on sines of a known phase (reference methods.md 3.1), and on simulated loops."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopHints
from agent.analysis.stiction.horch_ccf import EVEN_RHO, HorchCcf, cross_correlation
from tests.unit.stiction.loops import detect, sines

PERIOD = 60.0


@pytest.mark.parametrize(
    ("phase", "delta_rho", "delta_tau"),
    [(1 / 2, 1.0, 1.0), (2 / 3, 0.332, 0.666), (5 / 6, 0.0716, 0.333), (1.0, 0.0, 0.0)],
)
def test_phases_of_the_reference(phase, delta_rho, delta_tau):
    op, pv = sines(6000, PERIOD, phase * np.pi)
    seen = cross_correlation(op, pv, round(PERIOD))
    assert seen.delta_rho == pytest.approx(delta_rho, abs=0.02)
    assert seen.delta_tau == pytest.approx(delta_tau, abs=0.02)


@pytest.mark.parametrize(
    ("phase", "verdict"),
    [(0.5, "stiction"), (0.6, "stiction"), (0.75, "undecided"), (0.9, "no_stiction"), (1.0, "no_stiction")],
)
def test_the_rule(phase, verdict):
    assert detect(HorchCcf(), *sines(1500, PERIOD, phase * np.pi), PERIOD).verdict == verdict


def test_the_limits_are_those_of_a_phase_of_pi_over_six():
    assert pytest.approx(0.0718, abs=1e-4) == EVEN_RHO


def test_its_limits():
    op, pv = sines(280, PERIOD, np.pi / 2)
    assert "5 periods" in detect(HorchCcf(), op, pv, PERIOD).reason
    hints = LoopHints(integrating=True)
    assert "integrating" in detect(HorchCcf(), *sines(1500, PERIOD, np.pi / 2), PERIOD, hints=hints).reason
