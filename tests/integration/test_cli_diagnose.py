"""``slipjump diagnose`` as its user meets it: output, exit codes, one clear line for what is wrong."""

import json
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest

from agent.analysis.diagnosis import Diagnosis
from agent.analysis.record.recording import LoopHints, LoopWindow
from agent.analysis.results import Profile, Quantification
from agent.analysis.stiction.shapes.nearest_neighbours import prediction_error
from agent.analysis.stiction.shapes.time_warping import warped_distances
from agent.cli import main
from agent.cli.common.compilation import COMPILING
from agent.cli.common.pictures import draw

SLIPJUMP = Path(sys.executable).with_name("slipjump")
KEYS = [
    "recording",
    "loop",
    "verdict",
    "confidence",
    "probability",
    "sticks",
    "samples_per_period",
    "manual_percent",
    "cause",
    "causes",
    "class",
    "reasons",
    "advice",
    "oscillation",
    "no_response",
    "as_before",
    "stretches",
    "stiction",
    "repair",
    "process",
    "fit",
    "methods",
    "indices",
    "seconds",
]
HEAVY = "{'numba', 'scipy', 'matplotlib', 'pyarrow', 'asyncua'}"


@pytest.fixture
def slipjump(capsys):
    def _run(*words):
        with pytest.raises(SystemExit) as left:
            main([str(word) for word in words])
        out, err = capsys.readouterr()
        return left.value.code, out, err.replace(f"{COMPILING}\n", "")  # kernels may be cold in a test

    return _run


def write(path, op, pv, header="time,OP,PV"):
    rows = [f"{k},{u},{y}" for k, (u, y) in enumerate(zip(op, pv, strict=True))]
    path.write_text("\n".join([header, *rows, ""]))
    return path


@pytest.fixture
def still(tmp_path):
    return write(tmp_path / "STILL.csv", np.full(200, 42.0), np.sin(np.arange(200) / 5))


@pytest.fixture
def moving(tmp_path):
    t = np.arange(400)
    return write(tmp_path / "MOVING.csv", 50 + 5 * np.sin(t / 8), 20 + 2 * np.sin((t - 6) / 8))


def one_line(err):
    assert err.count("\n") == 1, err
    assert err.startswith("slipjump: ")
    assert "Traceback" not in err
    return err


def test_constant_op_is_not_testable_and_done(slipjump, still):
    code, out, err = slipjump("diagnose", still)
    assert (code, err) == (0, "")
    verdict, advice, reason = out.splitlines()
    assert (verdict, reason) == ("STILL: not testable", "  - OP does not move: it is constant at 42")
    assert advice.startswith("  > record the loop again")


def test_json_is_one_object_a_line(slipjump, still, moving):
    code, out, err = slipjump(
        "diagnose", still, moving, "--json", "--quantifier", "lee2008", "--delay", 6, "--order", 1
    )
    assert (code, err) == (0, "")
    first, second = [json.loads(line) for line in out.splitlines()]
    assert list(first) == list(second) == KEYS
    assert (first["recording"], first["loop"], first["verdict"]) == ("STILL.csv", "STILL", "not_testable")
    assert second["recording"] == "MOVING.csv"
    assert second["oscillation"]["detected"]
    assert second["oscillation"]["period_s"] == pytest.approx(2 * np.pi * 8, rel=0.05)


def test_one_bad_file_among_many(slipjump, still, tmp_path):
    bad = tmp_path / "BAD.csv"
    bad.write_text("time,OP,PV\n0,1,2\n1,open,2\n")
    code, out, err = slipjump("diagnose", bad, still, tmp_path / "none.csv", still, "--json")
    assert code == 2
    assert [json.loads(line)["loop"] for line in out.splitlines()] == ["STILL", "STILL"]
    first, second = err.splitlines()
    assert first == f"slipjump: {bad}, line 3: OP is 'open', expected a number or an empty cell"
    assert "none.csv: cannot be read: No such file or directory" in second


def test_recordings_that_are_named_for_one_valve_are_judged_together(slipjump, tmp_path):
    rng, t = np.random.default_rng(0), np.arange(300)
    op = 50 + 5 * np.sin(t / 8) + 0.2 * rng.normal(size=300)
    one, again = (
        write(tmp_path / f"FIC101_{k}.csv", op, 20 + 2 * np.sin((t - 6) / 8) + 0.1 * rng.normal(size=300))
        for k in (1, 2)
    )
    still = write(tmp_path / "FIC101_3.csv", np.full(300, 42.0), rng.normal(size=300))
    answers = {}
    for option in ("--json", "--each"):
        code, out, err = slipjump("diagnose", still, one, again, tmp_path / "FIC101_4.csv", "--json", option)
        assert code == 2
        assert "FIC101_4.csv: cannot be read" in one_line(err)
        answers[option] = [json.loads(line) for line in out.splitlines()]
        assert [each["loop"] for each in answers[option]] == ["FIC101_3", "FIC101_1", "FIC101_2"]
        assert all(list(each) == KEYS for each in answers[option])
    shared, alone = answers["--json"], answers["--each"]
    assert shared[0]["reasons"] == alone[0]["reasons"]
    assert shared[1]["reasons"] == alone[1]["reasons"]
    words = "this recording shows the same event as FIC101_1: the two count as one"
    assert shared[2]["reasons"] == [*alone[2]["reasons"], words]
    assert [each["verdict"] for each in shared] == [each["verdict"] for each in alone]


def test_one_valve_whatever_the_names(slipjump, still, moving):
    code, out, err = slipjump("diagnose", still, moving, moving, "--one-valve")
    assert (code, err) == (0, "")
    assert out.count("\nMOVING: ") == 2
    assert out.count("the same event as MOVING: the two count as one") == 1


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["x.csv", "--each", "--one-valve"], "--one-valve"),
        (["x.csv", "--quantifier", "lee2008", "--one-valve"], "no evidence to share"),
        ([], "Missing argument"),
        (["x.csv", "--delay", "0"], "--delay"),
        (["x.csv", "--order", "3"], "--order"),
        (["x.csv", "--ts", "0"], "--ts"),
        (["x.csv", "--ts", "nan"], "--ts"),
        (["x.csv", "--quantifier", "guess"], "lee2008"),
        (["x.csv", "--frobnicate"], "--frobnicate"),
        (["x.csv", "--plot", "/dev/null/x"], "--plot"),
    ],
)
def test_bad_usage(slipjump, words, expected):
    code, out, err = slipjump("diagnose", *words)
    assert (code, out) == (2, "")
    assert expected in one_line(err)


def test_unknown_command(slipjump):
    code, out, err = slipjump("frobnicate")
    assert (code, out) == (2, "")
    assert "frobnicate" in one_line(err)


def test_other_names_and_no_time_column(slipjump, tmp_path):
    path = tmp_path / "A.csv"
    path.write_text("CO,FLOW\n" + "".join(f"42,{k % 9}\n" for k in range(150)))
    code, out, _ = slipjump("diagnose", path, "--op", "CO", "--pv", "FLOW", "--ts", "5")
    assert code == 0
    assert "OP does not move" in out


def test_a_jump_in_time_that_makes_no_grid(slipjump, tmp_path):
    path = tmp_path / "A.csv"
    path.write_text("time,OP,PV\n0,1,2\n1,2,3\n2,2,3\n1e15,2,3\n")
    code, _, err = slipjump("diagnose", path)
    assert code == 2
    assert str(path) in one_line(err)


def test_pictures_of_loops_of_one_name(slipjump, still, tmp_path):
    other = tmp_path / "unit2" / "STILL.csv"
    other.parent.mkdir()
    other.write_bytes(still.read_bytes())
    code, _, err = slipjump("diagnose", still, other, "--plot", tmp_path / "pictures")
    assert (code, err) == (0, "")
    assert names(tmp_path / "pictures") == ["STILL.png", "STILL_2.png"]


def test_a_picture_that_cannot_be_written_does_not_cost_the_answer(slipjump, still, tmp_path):
    (tmp_path / "pictures" / "STILL.png").mkdir(parents=True)
    code, out, err = slipjump("diagnose", still, "--plot", tmp_path / "pictures")
    assert code == 2
    assert out.startswith("STILL: not testable")
    assert "STILL.png: cannot be written" in one_line(err)


def test_every_picture_of_a_loop_that_could_be_judged(slipjump, moving, tmp_path):
    words = ("--quantifier", "lee2008", "--delay", 6, "--order", 1, "--plot", tmp_path / "pictures")
    code, _, err = slipjump("diagnose", moving, *words)
    assert (code, err) == (0, "")
    assert names(tmp_path / "pictures") == ["MOVING-contour.png", "MOVING-detectors.png", "MOVING.png"]


def test_a_profile_is_drawn_where_the_quantifier_has_one(tmp_path):
    s = np.linspace(0.0, 4.0, 9)
    profile = Profile(s, np.exp(-((s - 2.0) ** 2)), delay=6.0 - s, j=s / 2, limit=0.1)
    found = Quantification("none", None, None, None, None, None, "undecided", profile=profile)
    wave = np.sin(np.arange(200.0) / 8)
    window = LoopWindow("A", 0.0, 1.0, wave, wave, hints=LoopHints(delay=1, order=1))
    diagnosis = Diagnosis("A", "undecided", 0.0, "undecided", (), None, None, found)
    assert draw(window, diagnosis, tmp_path / "A.2.png") == ()
    assert names(tmp_path) == ["A.2-contour.png", "A.2-profile.png", "A.2.png"]


def test_pictures_of_an_earlier_run_are_not_left_beside_those_of_this_one(tmp_path):
    for stem in ("A", "A-contour", "A-profile", "A-detectors", "B-profile"):
        (tmp_path / f"{stem}.png").write_bytes(b"\x89PNG of an earlier run")
    window = LoopWindow("A", 0.0, 1.0, np.zeros(200), np.zeros(200))
    nothing = Diagnosis("A", "not_testable", 0.0, "undecided", (), None, None, None)
    assert draw(window, nothing, tmp_path / "A.png") == ()
    assert names(tmp_path) == ["A.png", "B-profile.png"]
    assert b"of an earlier run" not in (tmp_path / "A.png").read_bytes()


def names(folder):
    assert all(picture.read_bytes().startswith(b"\x89PNG") for picture in folder.iterdir())
    return sorted(picture.name for picture in folder.iterdir())


def test_installed_command_is_quiet_and_quick_to_help(still):
    help_text = subprocess.run([SLIPJUMP, "--help"], capture_output=True, text=True, check=True, timeout=20)
    assert "diagnose" in help_text.stdout
    assert "warm" not in help_text.stdout
    done = subprocess.run(
        [SLIPJUMP, "diagnose", still, "--json"], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr == ""
    assert json.loads(done.stdout)["verdict"] == "not_testable"


def test_it_reports_its_version(slipjump):
    assert slipjump("--version") == (0, f"slipjump {version('slipjump')}\n", "")


@pytest.mark.timeout(300)  # where nothing is compiled yet
def test_warm_compiles_every_quantifier(slipjump):
    code, out, err = slipjump("warm")
    assert (code, err) == (0, "")
    assert "done in" in out
    detectors = (warped_distances, prediction_error)  # which short records do not reach
    assert all(kernel.signatures for kernel in detectors)


def test_help_imports_nothing_heavy():
    code = f"import sys, agent.cli; print(sorted({HEAVY} & set(sys.modules)))"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=20
    )
    assert done.stdout.strip() == "[]"


def test_industrial_loop_of_the_paper(slipjump, recordings):
    """Loop 6 of Table I (CHEM12): f_S = 0.78, f_D = 0.64."""
    code, out, err = slipjump(
        "diagnose", recordings / "isdb" / "CHEM12.csv", "--quantifier", "lee2008", "--json"
    )
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert found["verdict"] == "stiction"
    assert found["stiction"]["f_s"]["value"] == pytest.approx(0.78, abs=0.02)
    assert found["stiction"]["f_d"]["value"] == pytest.approx(0.64, abs=0.02)
