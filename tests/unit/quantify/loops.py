"""Loops whose valve is exactly one of the models, mostly that of He et al.: what a fit must give back."""

import numpy as np

from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.physics.processes.arx import Arx, simulate_arx
from agent.physics.valves.he2007 import he2007

FIRST_ORDER = Arx(a1=0.9, a2=0.0, b1=0.15, b2=0.0, bias=0.0, delay=4)
SECOND_ORDER = Arx(a1=1.6, a2=-0.63, b1=0.03, b2=0.015, bias=0.0, delay=4)
INTEGRATOR = Arx(a1=1.0, a2=0.0, b1=0.02, b2=0.0, bias=0.0, delay=4)


def swinging_op(samples=600, seed=0):
    """OP units, with a span of 20 and a mean of 50."""
    random = np.random.default_rng(seed)
    op = np.sin(2 * np.pi * np.arange(samples) / 60) + 0.05 * random.standard_normal(samples)
    return 50 + 20 * (op - op.mean()) / np.ptp(op)


def loop(op, f_s, f_d, process=FIRST_ORDER, noise=0.02, hints=None, valve=he2007):
    mv = valve(op, f_s, f_d, op[0])
    model = np.nan_to_num(simulate_arx(process, mv - mv.mean(), np.zeros(len(op))))
    pv = 100 + model + noise * np.random.default_rng(1).standard_normal(len(op))
    return LoopWindow("FIC101", 0.0, 2.0, op, pv, hints=hints or LoopHints())
