"""A visible failure that a small effect mends has an explanation; one that nothing mends has none."""

import pytest

from agent.analysis.record.recording import LoopWindow
from agent.workbench.checks.mended import LITTLE
from agent.workbench.residual.state_dependence import fails
from agent.workbench.session import Workbench
from simulators.draws.open_records import open_record


@pytest.fixture(scope="module")
def zero():
    """A zero in PRBS behind a valve with a lag of 0.4 s, which a model without it makes up for elsewhere."""
    record = open_record(91546, "prbs", "inverse_response")
    window = LoopWindow("zero", 0.0, record.scenario.ts, record.op, record.pv)
    bench = Workbench(window)
    bench.add("inverse_response")
    return bench


def test_the_lag_that_a_model_fails_without_is_suggested(zero):
    assert fails(zero.step.estimate.dependence)
    verdict = zero.comparison().verdict
    assert (verdict.kind, verdict.lacks) == ("suggested", (LITTLE,))
    # A limit of its speed is as likely within 0.4 of twice a logarithm: last digits decide which is named.
    assert verdict.family in {"extra_lag", "valve_speed"}


def test_what_else_mends_it_is_named_beside_it(zero):
    verdict = zero.comparison().verdict
    assert {"sensor_lag", "second_order", "actuator_lag", "rate_limit"} <= {
        verdict.effect,
        *verdict.indistinguishable,
    }


def test_without_any_of_them_nothing_is_suggested(zero):
    others = ("extra_lag", "valve_speed", "sensor_hysteresis", "process_delay")
    other = Workbench(zero.window, without=others)
    other.add("inverse_response")
    assert other.comparison().verdict.kind == "none_of_the_known"
