"""The conversation of compare: what it proposes, what it refuses, what it keeps."""

import os

import numpy as np
import pytest
from loops import made, slack

from agent.analysis.record.recording import LoopWindow
from agent.cli.comparing.conversation import Conversation, Files
from agent.cli.comparing.kept_sessions import MOST, read_session, session_key, write_session
from agent.cli.comparing.outputs import write_report
from agent.physics.effects import EFFECTS
from agent.report.comparison_text import comparison_lines
from agent.report.headline import headline
from agent.workbench.hooks import silent
from agent.workbench.residual.axes import UNITS
from agent.workbench.residual.axis_effects import FAMILIES_ON
from agent.workbench.session import Workbench
from agent.workbench.session.kept import dumped, loaded

pytestmark = pytest.mark.timeout(240)  # a cold cache of kernels takes a minute
FEW = tuple(each.name for each in EFFECTS if each.name not in {"deadband", "sensor_lag", "load_step"})


class Terminal:
    """A user who types these lines, and what is printed to her."""

    def __init__(self, *typed):
        self.typed, self.prompts, self.printed = list(typed), [], []

    def read(self, prompt):
        self.prompts.append(prompt)
        return self.typed.pop(0) if self.typed else None

    @property
    def text(self):
        return "\n".join(self.printed)


def talk(bench, *typed, files=None, keep=lambda _: None):
    terminal = Terminal(*typed)
    files = files or Files(lambda *_: "written", lambda *_: "written")
    Conversation(bench, terminal.read, terminal.printed.append, files, keep).run()
    return terminal


@pytest.fixture(scope="module")
def fresh():
    """A session of a slack valve, with its candidates tried, as bytes."""
    bench = Workbench(slack(), without=FEW)
    bench.comparison()
    return dumped(bench)


def resumed(data, progress=silent):
    return loaded(data, map, progress)


@pytest.fixture(scope="module")
def added(fresh):
    """The same session after Enter and quit: its terminal, and the session as it was kept."""
    kept = []
    terminal = talk(resumed(fresh), "", "quit", "1", keep=lambda each: kept.append(dumped(each)))
    return terminal, kept[-1]


def test_enter_adds_what_is_proposed_and_the_staircase_falls(added):
    terminal, kept = added
    bench = resumed(kept)
    assert bench.step.effects == ("deadband",)
    assert terminal.prompts[0].startswith("Enter adds deadband, ")
    assert "verdict: deadband is missing" in terminal.text
    assert "found: deadband S" in terminal.text
    assert "held-out error -" in terminal.text
    assert terminal.typed == ["1"]  # after quit nothing is read


def test_who_goes_the_same_way_again_gets_the_same_step_and_nothing_is_fitted(added):
    first, kept = added
    work = []
    bench = resumed(kept, lambda what, *_: work.append(what))
    before = bench.step
    second = talk(bench, "undo", "1").printed
    assert bench.step is before
    assert work == []
    shown = [line for line in first.printed if line in second]
    assert len(shown) > len(first.printed) / 3
    assert shown[-1] == first.printed[-1] == second[-1]


def test_a_kept_session_goes_on_where_it_was(added):
    first, kept = added
    work = []
    again = resumed(kept, lambda what, *_: work.append(what))
    assert again.step.effects == ("deadband",)
    assert headline(again.comparison()) in first.text
    assert work == []


@pytest.mark.parametrize(
    ("typed", "answer"),
    [
        ("fly", "'fly' is no command; ? lists them"),
        ("99", "there is no candidate 99; numbers go from 1 to 1"),
        ("undo", "there is no step to undo"),
        ("add slip", "no effect 'slip'"),
        ("drop deadband", "the model has no deadband"),
        ("add", "add which effect?"),
        ("report", "to which file?"),
        ("report x.pdf", "ends with .html"),
        ("where nowhere", "the axes are "),
        ("?", "goes back one step"),
        ("where op_level", "op level (OP), mean residual"),
    ],
)
def test_each_line_gets_an_answer_and_changes_nothing(fresh, typed, answer):
    bench = resumed(fresh)
    assert answer in talk(bench, typed).text
    assert bench.step.effects == ()


def test_the_report_begins_with_what_was_found_and_ends_with_what_could_not_be_seen(added, tmp_path):
    bench = resumed(added[1])
    path = tmp_path / "report.html"
    files = Files(lambda bench, found, _: str(write_report(bench, found, path)), lambda *_: "")
    talk(bench, f"report {path}", files=files)
    page = path.read_text(encoding="utf-8")
    found = bench.comparison()
    words = headline(found)
    assert page.index(words[1:]) < page.index("How far the error falls") < page.index("Step 1: + deadband")
    assert page.index("Step 1") < page.index("tried") < page.rindex("What could not have been seen")
    for each in found.unseen:
        assert each.split(":")[0].split(" (")[0] in page
    assert f"{found.evidence[1].candidates[0].error_reduction_percent:.1f}" in page


def test_a_loop_whose_op_explains_nothing_is_not_informative():
    rng = np.random.default_rng(3)
    op = made().op
    pv = 50 + np.convolve(rng.standard_normal(len(op) + 19), np.exp(-np.arange(20) / 5), "valid")
    found = Workbench(LoopWindow("still", 0.0, 1.0, op, pv), without=FEW).comparison()
    assert found.verdict.kind == "not_testable"
    assert "not informative: OP explains" in found.reason
    assert len(found.steps) == 1
    assert "record a stretch where the set point moves" in list(comparison_lines(found))[-1]


def test_saved_parameters_are_those_that_are_printed(added):
    bench = resumed(added[1])
    saved = bench.save()["parameters"]
    assert saved == {each.name: each.value for each in bench.step.parameters}


def test_each_axis_names_effects_and_each_family_has_an_axis():
    assert FAMILIES_ON.keys() == UNITS.keys()
    assert {each.family for each in EFFECTS} == {each for names in FAMILIES_ON.values() for each in names}


def test_a_candidate_that_seems_large_says_what_rejects_it(fresh):
    for each in resumed(fresh).candidates().candidates:
        if each.error_reduction_percent >= 5 and each.low > 0 and each.p >= 0.05:
            assert each.objection


def test_sessions_are_bounded_private_and_named_by_all_that_matters(tmp_path):
    folder = tmp_path / "sessions"
    for number in range(MOST + 3):
        write_session(folder, f"{number:03}", b"session")
        os.utime(folder / f"{number:03}.session", (number, number))
    write_session(folder, "last", b"newest")
    assert len(list(folder.iterdir())) == MOST
    assert read_session(folder, "last") == b"newest"
    assert read_session(folder, "000") is None
    path = folder / "last.session"
    assert path.stat().st_mode & 0o777 == 0o600
    path.chmod(0o666)
    assert read_session(folder, "last") is None
    path.chmod(0o600)
    path.write_bytes(b"rubbish")
    assert read_session(folder, "last") is None
    assert session_key([b"ab", b"c"]) != session_key([b"a", b"bc"])


def test_what_is_no_session_is_refused():
    with pytest.raises(ValueError, match="no kept session"):
        loaded(b"rubbish", map, silent)
