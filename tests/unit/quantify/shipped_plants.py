"""The shipped simulated plants as windows that `free_run` quantifies, each computed once."""

from functools import cache

from agent.analysis.quantify.free_run import FreeRun
from agent.analysis.record.recording import LoopWindow
from simulators.plant import simulate
from simulators.scenario import load_scenario
from tests.conftest import ROOT

SAMPLES = 1200
FREE_RUN = FreeRun()


@cache
def plant(name):
    """A scenario and the window that the demo would see of it first."""
    scenario = load_scenario(ROOT / "config" / "scenarios" / f"{name}.yaml")
    record = simulate(scenario)
    return scenario, LoopWindow(scenario.loop, 0.0, scenario.ts, record.op[:SAMPLES], record.pv[:SAMPLES])


@cache
def measured(name):
    return FREE_RUN.quantify(plant(name)[1])


def true_s(name):
    truth = plant(name)[0].truth
    return truth.f_s + truth.f_d


def op_span(name):
    return plant(name)[1].op_span
