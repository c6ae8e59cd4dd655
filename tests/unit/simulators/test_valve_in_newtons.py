"""A published valve in newtons and metres, as a simulated one in per cent of OP: set A of methods.md 1.8."""

import numpy as np
import pytest

from agent.units import FrictionBands
from simulators.parameters import ValveParameters
from simulators.valve import SimulatedValve

MASS, SPRING = 1.6, 210_490.0  # kg, N/m
AREA, LOW, HIGH = 0.0445, 41_368.0, 180_000.0  # m2, Pa, Pa
KINETIC, STATIC = 700.0, 780.0  # N
VISCOUS, STRIBECK = 125_000.0, 5e-4  # N s/m, m/s
PERCENT = AREA * (HIGH - LOW) / 100  # N, what one per cent of OP changes
BANDS = FrictionBands(f_s=STATIC / PERCENT, f_d=KINETIC / PERCENT)
PARAMETERS = ValveParameters(
    law="karnopp",
    f_s=BANDS.f_s,
    f_d=BANDS.f_d,
    tau_ip=0.0,
    inertia=MASS / SPRING,
    damping=VISCOUS / SPRING,
    stribeck=STRIBECK * SPRING / PERCENT / 100,
)


def test_friction_in_per_cent_of_op_is_that_of_the_force_over_the_range():
    assert (BANDS.f_s, BANDS.f_d) == (pytest.approx(12.64, abs=0.01), pytest.approx(11.35, abs=0.01))
    assert (BANDS.s, BANDS.j) == (pytest.approx(23.99, abs=0.01), pytest.approx(1.30, abs=0.01))


def test_the_simulated_valve_breaks_away_at_its_static_friction():
    valve = SimulatedValve(PARAMETERS, (0.0, 100.0), 50.0)  # it starts f_S behind
    start = valve.position
    broke_away = next(op for op in np.arange(50.0, 51.0, 0.01) if valve.stroke(op, 500, 0.002)[-1] > start)
    assert broke_away - start == pytest.approx(12.64, abs=0.02)


def test_it_slides_behind_by_kinetic_and_viscous_friction():
    valve = SimulatedValve(PARAMETERS, (0.0, 100.0), 20.0)
    slope, dt = 10.0, 0.002  # OP units per second
    op = np.arange(20.0, 80.0, slope * dt)
    behind = op[-1] - [valve.stroke(each, 1, dt)[-1] for each in op][-1]
    assert behind == pytest.approx(11.35 + slope * PARAMETERS.damping, abs=0.05)
