"""Records that the workbench's own physics makes: here the identifier's formulas are the truth."""

from __future__ import annotations

import numpy as np

from agent.analysis.record.recording import LoopWindow
from agent.physics.bases import Fopdt
from agent.physics.effects.deadband import Deadband
from agent.physics.loop_model import LoopModel
from agent.workbench.record import bare_record

DELAY, TAU, GAIN, LEVEL = 4.0, 9.0, -1.5, 60.0
S = 3.0
STEM = 0.1
"""Lag of the stem before the slack, s."""


def moves(samples=800, seed=0):
    """OP of a loop that swings with a period of about 40 samples."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples)
    slow = np.convolve(rng.standard_normal(samples + 99), np.ones(100) / 10, mode="valid")
    return 50 + 5 * np.sin(2 * np.pi * t / 40 + 0.5 * slow) + slow


def made(effects=(), values=(), noise=0.05, samples=800, seed=0, loop="made"):
    """A window of FOPDT with ``effects``, gain ``GAIN``, and white noise."""
    op = moves(samples, seed)
    blank = LoopWindow(loop, 0.0, 1.0, op, op)
    model = LoopModel(Fopdt(), effects)
    facts = bare_record(blank).facts
    response = model.columns(op, np.array([DELAY, TAU, *values]), facts)[:, 0]
    noisy = noise * np.random.default_rng(seed + 1).standard_normal(samples)
    return LoopWindow(loop, 0.0, 1.0, op, LEVEL + GAIN * response + noisy)


def slack(**options):
    """The same with a dead band of ``S``."""
    return made((Deadband(),), (S, 0.0, STEM), **options)
