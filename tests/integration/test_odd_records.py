"""``slipjump diagnose`` on records that hold little or nothing: a verdict for each, and why."""

import json

import numpy as np
import pytest

from agent.cli import main
from agent.physics.processes import PROCESSES

N = 600
RNG = np.random.default_rng(7)
T = np.arange(N)
OP = 50 + 10 * np.sin(2 * np.pi * T / 60) + 0.2 * RNG.standard_normal(N)
LONG = 50 + 10 * np.sin(2 * np.pi * np.arange(20_000) / 60)
KNOWN = np.isin(T, RNG.choice(N, 80, replace=False))


def answer(op):
    """PV of a free valve with a little noise."""
    noise = 0.02 * np.ptp(op) * RNG.standard_normal(len(op))
    return 100 + PROCESSES[0].respond(op, (10.0, 3.0)) + noise


PV = answer(OP)
NOT_TESTABLE = {
    "three_values": (np.round(OP / 10) * 10, PV),
    "three_values_20000": (np.round(LONG / 10) * 10, answer(LONG)),
    "constant_pv": (OP, np.full(N, 3.0)),
    "step": (np.where(T < 300, 40.0, 60.0), answer(np.where(T < 300, 40.0, 60.0))),
    "sixty": (OP[:60], PV[:60]),
    "eighty_known": (np.where(KNOWN, OP, np.nan), np.where(KNOWN, PV, np.nan)),
}
NO_STICTION = {
    "ramp": (40 + 0.02 * T, 100 + PROCESSES[0].respond(40 + 0.02 * T, (10.0, 3.0))),
    "noisy_ramp": (40 + 0.02 * T, answer(40 + 0.02 * T)),
    "huge": (1e12 * OP, 1e12 * PV),
    "tiny": (1e-12 * OP, 1e-12 * PV),
}


def diagnosed(records, folder, capsys):
    """Verdict and reasons by the name of the record."""
    files = []
    for name, (op, pv) in records.items():
        rows = [f"{k},{u},{y}" for k, (u, y) in enumerate(zip(op.tolist(), pv.tolist(), strict=True))]
        files.append(folder / f"{name}.csv")
        files[-1].write_text("\n".join(["time,OP,PV", *rows, ""]).replace("nan", ""))
    with pytest.raises(SystemExit) as left:
        main(["diagnose", "--json", *map(str, files)])
    assert left.value.code == 0
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    return {answer["recording"]: (answer["verdict"], answer["reasons"]) for answer in found}


def test_a_record_that_can_report_nothing_is_not_testable(tmp_path, capsys):
    found = diagnosed(NOT_TESTABLE, tmp_path, capsys)
    assert len(found) == len(NOT_TESTABLE)
    for verdict, reasons in found.values():
        assert (verdict, bool(reasons)) == ("not_testable", True)


@pytest.mark.slow
def test_a_free_valve_is_none_that_sticks_on_a_ramp_or_at_any_size(tmp_path, capsys):
    found = diagnosed(NO_STICTION, tmp_path, capsys)
    assert len(found) == len(NO_STICTION)
    assert {verdict for verdict, _ in found.values()} <= {"no_stiction", "undecided", "not_testable"}
