"""Of a very long recording the part in which OP moves most is compared, and the answer states which."""

import numpy as np
import pytest

from agent.analysis.record.recording import LoopWindow
from agent.cli.comparing import guide
from agent.cli.comparing.several import together
from agent.physics.effects import EFFECTS
from agent.web.workbench.same_lines import ReadSource, python_of
from agent.workbench.session import Workbench, compared_part
from agent.workbench.session.step_tree import StepTree

SHORT = 400
WITHOUT = {each.family for each in EFFECTS} - {"disturbance"}


@pytest.fixture
def short(monkeypatch):
    monkeypatch.setattr(compared_part, "LONGEST", SHORT)


def recording():
    """OP moves most in the third of three parts."""
    rng = np.random.default_rng(5)
    op = 50 + np.repeat(rng.uniform(-2, 2, 60), 20)
    op[800:] = 50 + 4 * (op[800:] - 50)
    pv = np.convolve(op - 50, 0.1 * 0.9 ** np.arange(80))[: len(op)] + 0.1 * rng.normal(size=len(op))
    return LoopWindow("loop", 0.0, 2.0, op, pv)


@pytest.mark.usefixtures("short")
def test_the_part_is_fitted_and_stated():
    feed = np.arange(1200.0)
    bench = Workbench(recording(), without=WITHOUT, inputs={"feed": feed}, other_inputs={"feed": feed})
    assert (bench.part.where, len(bench.window), bench.window.start) == (slice(800, 1200), SHORT, 1600.0)
    first = bench.comparison().unseen[0]
    assert "before 1600 s and after 2400 s" in first
    assert "of 1200 samples 400 are compared" in first


@pytest.mark.usefixtures("short")
def test_the_page_has_it_too_also_where_a_stretch_is_left_out():
    tree = StepTree(recording(), "fopdt", map, lambda *_: None)
    assert len(tree.window) == SHORT
    tree.leave_out((100.0, 140.0))
    line = "window = part_of(window, slice(800, 1200))"
    assert all(line in python_of(ReadSource("x.csv"), each) for each in tree.nodes)
    by_number = ReadSource("x.dat", {"op": "1", "pv": "2", "ts": "0.5"})
    assert "Columns(op='1', pv='2', ts=0.5)" in python_of(by_number, tree.nodes[0])


def test_others_are_compared_whole():
    bench = Workbench(recording(), without=WITHOUT)
    assert (bench.part, len(bench.window)) == (None, 1200)


@pytest.mark.usefixtures("short")
def test_several_recordings_state_it_each(capsys):
    windows = {"a.csv": recording(), "b.csv": recording()}
    hooks = {"run": map, "progress": lambda *_: None}
    recorded = {name: (window, {}) for name, window in windows.items()}
    together(recorded, "sopdt", sorted(WITHOUT), EFFECTS, (), **hooks, auto=False)
    errors = capsys.readouterr().err
    assert [f"{name}: not compared: what happened before 1600 s" in errors for name in windows] == [
        True,
        True,
    ]


@pytest.mark.usefixtures("short")
def test_a_conversation_begins_with_it(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("SLIPJUMP_SESSIONS", str(tmp_path))
    monkeypatch.setattr(guide, "_read", lambda _: "quit")
    file = tmp_path / "x.csv"
    file.write_text("")
    guide.guide(guide.Question(recording(), "sopdt", None, tuple(sorted(WITHOUT)), EFFECTS, (file,), ""))
    assert "not compared: what happened before 1600 s" in capsys.readouterr().err
