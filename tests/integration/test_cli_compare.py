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
    t = np.arange(500)
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
    nothing_to_try = (*QUICK, "--without", "valve_hysteresis")
    code, out, _ = slipjump("compare", recording, *nothing_to_try, "--load", model, "--drop", "deadband")
    assert code == 0
    assert "- deadband" in out
    other = recording.with_name("FIC8.csv")
    other.write_text(recording.read_text())
    code, out, err = slipjump("compare", other, "--load", model, *nothing_to_try)
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


MODEL = {
    "kind": "slipjump model",
    "loop": "FIC7",
    "base": "fopdt",
    "effects": ["deadband"],
    "parameters": {
        "delay": 1.0,
        "tau": 8.0,
        "deadband.s": 3.0,
        "deadband.start": 0.0,
        "deadband.damping": 0.1,
    },
}


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("kind: [slipjump\n  model: {", "expected ',' or ']'"),
        ("- deadband", "no saved model: 'kind: slipjump model' is missing"),
        (MODEL | {"loop": "FIC8"}, "of the loop FIC8, not of FIC7"),
        (MODEL | {"effects": ["fairy"]}, "no effect 'fairy'; there are deadband"),
        (MODEL | {"effects": ["overflow"]}, "overflow does not apply to the base fopdt"),
        (MODEL | {"parameters": {"delay": 1.0, "tau": 8.0}}, "no value of deadband.s"),
        (MODEL | {"parameters": {"delay": float("nan")}}, "parameters must be finite numbers"),
    ],
    ids=["broken", "list", "other loop", "unknown effect", "other base", "missing value", "not a number"],
)
def test_a_model_that_cannot_be_loaded_is_one_line(slipjump, recording, tmp_path, text, expected):
    file = tmp_path / "model.yaml"
    file.write_text(text if isinstance(text, str) else yaml.safe_dump(text))
    code, out, err = slipjump("compare", recording, "--load", file, *QUICK)
    assert (code, out) == (2, "")
    assert "model.yaml" in err
    assert expected in err
    assert len([line for line in err.splitlines() if "compiling" not in line]) == 1


def rows_of(kind):
    t = np.arange(20 if kind == "short" else 400)
    op = 50 + 0 * t if kind == "still" else 50 + 5 * np.sin(t / 6)
    pv = 20 + 2 * np.sin((t - 6) / 6)
    return [
        f"{at},{u:.3f},{'Bad' if kind == 'gaps' else format(y, '.3f')}"
        for at, u, y in zip(t, op, pv, strict=True)
    ]


@pytest.mark.parametrize(
    ("kind", "reason"),
    [
        ("short", "only 20 samples"),
        ("gaps", "only 0 samples"),
        ("still", "OP does not move"),
    ],
)
def test_a_record_that_reports_nothing_is_no_failure(slipjump, recording, tmp_path, kind, reason):
    file = tmp_path / f"{kind}.csv"
    file.write_text("time,OP,PV\n" + "\n".join(rows_of(kind)) + "\n")
    code, out, _ = slipjump("compare", file, "--auto", "--json")
    assert code == 0
    found = json.loads(out)
    assert found["verdict"]["kind"] == "not_testable"
    assert reason in found["reason"]
    assert found["steps"] == []
    code, out, _ = slipjump("compare", file, "--add", "stiction")
    assert (code, "not testable" in out) == (0, True)
    if kind in {"short", "gaps"}:
        code, out, err = slipjump("compare", recording, "--validate", file, *QUICK)
        assert (code, err) == (0, "")
        assert f"{kind} cannot validate anything: {reason}" in out
        assert "verdict: " in out


def test_a_bump_test_in_manual_is_compared_and_says_what_it_cannot_show(slipjump, tmp_path):
    op = np.repeat([50.0, 60.0, 50.0], [60, 120, 120])
    pv = np.zeros(300)
    for i in range(299):
        pv[i + 1] = pv[i] + (0.5 * op[i] - pv[i] if i else 25.0) / (8 if i else 1)
    pv += 0.05 * np.random.default_rng(0).standard_normal(300)
    file = tmp_path / "bump.csv"
    rows = [f"{i},{u:g},{y:.4f},MAN" for i, (u, y) in enumerate(zip(op, pv, strict=True))]
    file.write_text("time,OP,PV,mode\n" + "\n".join(rows) + "\n")
    code, out, _ = slipjump("compare", file, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["verdict"]["kind"] == "no_failure_visible"
    assert found["steps"][0]["parameters"]["tau"]["value"] == pytest.approx(8.0, rel=0.1)
    why = {each["effect"]: each["why"] for each in found["not_shown"]}
    assert "deadband" not in why  # the valve does not come back to where it was
    assert "another gain" in why["characteristic"]
