"""Windows and answers of quantifiers by hand, and the diagnosis that follows."""

from dataclasses import dataclass, replace

import numpy as np

from agent.analysis.diagnose import diagnose
from agent.analysis.record.recording import LoopWindow
from agent.analysis.results import ProcessEstimate, Quantification, StictionEstimate
from agent.units import FrictionBands

N = 600


T = np.arange(N)


WAVE = np.sin(2 * np.pi * T / 60)


NOISE = np.random.default_rng(0).normal(size=N)


WINDOW = LoopWindow("FIC101", 0.0, 1.0, op=50 + 5 * WAVE + 0.1 * NOISE, pv=20 + 2 * WAVE + 0.1 * NOISE)


LOST_PHASE = np.sin(2 * np.pi * T / 60 + 1.5 * np.sin(2 * np.pi * T / 400))


SHAKEN = LoopWindow("FIC101", 0.0, 1.0, op=50 + 5 * LOST_PHASE, pv=20 + 2 * LOST_PHASE + 0.1 * NOISE)
"""As a loop close to instability swings: regular, but its phase wanders."""


CALM = LoopWindow("FIC101", 0.0, 1.0, op=50 + NOISE, pv=20 + np.roll(NOISE, 100))


STICKING = Quantification(
    quantifier="told",
    stiction=StictionEstimate.of(FrictionBands(2.0, 1.0)),
    process=ProcessEstimate("fopdt", 1.0, 5.0, 2.0),
    free_run_percent=90.0,
    linear_percent=60.0,
    evidence=16.0,
    decision="stiction",
    model_pv=WINDOW.pv,
    model_mv=WINDOW.op,
    quick_evidence=16.0,
    turns=20,
    log_likelihood_ratio=300.0,
)


HEALTHY = replace(
    STICKING,
    stiction=None,
    free_run_percent=95.0,
    linear_percent=95.0,
    evidence=1.0,
    decision="no_stiction",
    quick_evidence=1.0,
    turns=0,
    log_likelihood_ratio=0.0,
)


@dataclass(frozen=True)
class Told:
    """A quantifier that answers what the test wants."""

    answer: Quantification
    name: str = "told"

    def quantify(self, _window):
        return self.answer


def judged(window, answer):
    return diagnose(window, quantifier=Told(answer))
