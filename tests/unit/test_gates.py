"""Each thing that makes a record untestable is named; a good record passes."""

import numpy as np
import pytest

from agent.analysis.gates import gates
from agent.analysis.mode import automatic_share
from agent.analysis.recording import LoopHints, LoopWindow
from connectors.recording import read_recording

N = 400
T = np.arange(N)
WAVE = np.sin(2 * np.pi * T / 50)


def faults(op=50 + 10 * WAVE, pv=100 + WAVE, **rest):
    return [
        fault.name for fault in gates(LoopWindow("x", 0.0, 1.0, op=np.asarray(op), pv=np.asarray(pv), **rest))
    ]


def with_gaps(values, count):
    lost = values.copy()
    lost[:count] = np.nan
    return lost


def test_good_record():
    assert faults() == []
    assert faults(op=with_gaps(50 + WAVE, 100)) == []


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ({"op": [], "pv": []}, "few_samples"),
        ({"pv": np.full(N, np.nan)}, "few_samples"),
        ({"pv": np.where(T < 330, np.inf, WAVE)}, "few_samples"),
        ({"pv": with_gaps(WAVE, 250)}, "gaps"),
        ({"automatic": T % 2 == 0}, "manual"),
        ({"op": np.full(N, 55.5)}, "op_constant"),
        ({"op": np.zeros(N)}, "op_constant"),
        ({"op": 1e6 + 1e-7 * WAVE}, "op_constant"),
        ({"op": 50 + 0.05 * WAVE, "hints": LoopHints(op_range=(0.0, 100.0))}, "op_still"),
        ({"op": np.round(2 * WAVE)}, "op_quantised"),
        ({"op": np.maximum(WAVE, 0)}, "op_saturated"),
        ({"op": np.clip(50 + 90 * WAVE, 0, 100), "hints": LoopHints(op_range=(0.0, 100.0))}, "op_saturated"),
        ({"pv": np.full(N, -3.0)}, "pv_constant"),
        ({"pv": np.round(WAVE)}, "pv_quantised"),
    ],
)
def test_faults(case, expected):
    assert faults(**case) == [expected]


def test_reasons_are_sentences_with_numbers():
    (fault,) = gates(LoopWindow("x", 0.0, 1.0, op=np.full(N, 55.5), pv=WAVE))
    assert fault.reason == "OP does not move: it stands at 55.5"


def test_several_faults_are_all_told():
    assert faults(op=np.full(N, 1.0), pv=np.full(N, 1.0), automatic=T < 0) == [
        "manual",
        "op_constant",
        "pv_constant",
    ]


def test_modes():
    np.testing.assert_array_equal(
        automatic_share(["AUTO", "cas", "RCAS", " Man ", "MANUAL", "0", "1", ""]),
        [1, 1, 1, 0, 0, 0, 1, np.nan],
    )


@pytest.mark.parametrize("name", ["CHEM1", "CHEM10", "CHEM11", "CHEM12", "CHEM13", "PAP2", "PAP4"])
def test_industrial_loops_pass(recordings, name):
    loop = read_recording(recordings / "isdb" / f"{name}.csv")
    assert gates(LoopWindow(name, 0.0, 1.0, op=loop.op, pv=loop.pv)) == ()
