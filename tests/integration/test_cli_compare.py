"""``slipjump compare`` as its user meets it: output, exit codes, one clear line for what is wrong."""

import json

import numpy as np
import pytest
import yaml

from agent.cli import main

pytestmark = pytest.mark.timeout(240)
ALL_BUT_SLACK = ["valve_limits", "valve_characteristic", "valve_speed", "extra_lag", "process_dynamics"]
ALL_BUT_SLACK += ["disturbance", "gain", "stiction", "asymmetric_stiction"]
QUICK = [word for each in ALL_BUT_SLACK for word in ("--without", each)]


@pytest.fixture
def slipjump(capsys):
    def _run(*words):
        with pytest.raises(SystemExit) as left:
            main([str(word) for word in words])
        said = capsys.readouterr()
        return left.value.code, said.out, said.err

    return _run


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """A loop with a dead band of 3 between OP and a lag of 8 samples."""
    t = np.arange(700)
    op = 50 + 6 * np.sin(2 * np.pi * t / 35 + np.sin(t / 70))
    plug, pv = op[0], [20.0]
    for u in op[:-1]:
        plug = min(max(plug, u - 1.5), u + 1.5)
        pv.append(pv[-1] + (0.5 * plug - pv[-1]) / 8)
    pv = np.array(pv) + 0.02 * np.random.default_rng(0).standard_normal(len(t))
    file = tmp_path_factory.mktemp("compare") / "FIC7.csv"
    np.savetxt(file, np.column_stack((t, op, pv)), delimiter=",", header="time,OP,PV", comments="")
    return file


def test_auto_finds_the_slack_and_writes_model_and_page(slipjump, recording, tmp_path):
    model, page = tmp_path / "m.yaml", tmp_path / "r.html"
    code, out, err = slipjump(
        "compare", recording, *QUICK, "--auto", "--json", "--save", model, "--report", page
    )
    assert (
        code,
        err.replace("slipjump: compiling the numerical kernels, once (about a minute) ...\n", ""),
    ) == (0, "")
    found = json.loads(out)
    assert list(found)[:3] == ["recording", "loop", "steps"]
    assert [step["added"] for step in found["steps"]] == [None, "deadband"]
    assert found["steps"][1]["parameters"]["deadband.s"]["value"] == pytest.approx(3.0, rel=0.05)
    assert yaml.safe_load(model.read_text())["effects"] == ["deadband"]
    assert "<html" in page.read_text()
    code, out, _ = slipjump("compare", recording, *QUICK, "--load", model, "--drop", "deadband")
    assert code == 0
    assert "- deadband" in out
    other = recording.with_name("FIC8.csv")
    other.write_text(recording.read_text())
    code, out, err = slipjump("compare", other, "--load", model)
    assert (code, out) == (2, "")
    assert "of the loop FIC7, not of FIC8" in err


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("--add", "slip"), "no effect 'slip'; there are deadband"),
        (("--without", "fairies"), "no effect or family 'fairies'; there are"),
        (("--base", "third"), "no base 'third'; there are fopdt"),
        (("--drop", "stiction"), "the model has no stiction"),
        (("--validate", "nowhere.csv"), "nowhere.csv"),
        (("--load", "nowhere.yaml"), "nowhere.yaml"),
    ],
)
def test_what_does_not_exist_is_one_line(slipjump, recording, words, expected):
    code, out, err = slipjump("compare", recording, *words)
    assert (code, out) == (2, "")
    assert expected in err
    assert len([line for line in err.splitlines() if "compiling" not in line]) == 1


def test_a_record_that_tells_nothing_is_no_failure(slipjump, tmp_path):
    file = tmp_path / "still.csv"
    rows = [f"{t},50,{20 + 0.1 * (t % 7)}" for t in range(400)]
    file.write_text("time,OP,PV\n" + "\n".join(rows) + "\n")
    code, out, _ = slipjump("compare", file, "--auto", "--json")
    assert code == 0
    found = json.loads(out)
    assert found["verdict"]["kind"] == "not_testable"
    assert found["steps"] == []
    code, out, _ = slipjump("compare", file, "--add", "stiction")
    assert (code, "not testable" in out) == (0, True)
