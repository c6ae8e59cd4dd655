"""Each decision has a status and a line in the index; one that is superseded names the one that holds now."""

import re

import pytest

from tests.conftest import ROOT

FOLDER = ROOT / "docs" / "decisions"
DECISIONS = sorted(FOLDER.glob("[0-9]*.md"))
INDEX = (FOLDER / "index.md").read_text(encoding="utf-8")
STATUS = re.compile(
    r"Status: (?:accepted|(?P<how>superseded|accepted, in part superseded)"
    r" by \[(?P<n>\d+)\]\((?P<file>\S+)\))"
)


def number(path):
    return int(path.name[:4])


def status(path):
    """The third line of a decision, below its title."""
    found = STATUS.fullmatch(path.read_text(encoding="utf-8").splitlines()[2])
    assert found, f"{path.name}: line 3 must be 'Status: accepted' or 'Status: superseded by [N](file)'"
    return found


def test_decisions_are_numbered_without_a_gap():
    assert [number(path) for path in DECISIONS] == list(range(1, len(DECISIONS) + 1))
    for path in DECISIONS:
        assert path.read_text(encoding="utf-8").startswith(f"# {number(path)}. ")


@pytest.mark.parametrize("path", DECISIONS, ids=lambda path: path.stem)
def test_a_superseded_decision_names_a_later_one_that_holds(path):
    found = status(path)
    if found["how"]:
        successor = FOLDER / found["file"]
        assert successor.is_file()
        assert number(successor) == int(found["n"]) > number(path)
        assert not (status(successor)["how"] or "").startswith("superseded")


@pytest.mark.parametrize("path", DECISIONS, ids=lambda path: path.stem)
def test_the_index_has_one_line_of_each_decision_with_its_status(path):
    lines = [line for line in INDEX.splitlines() if f"]({path.name})" in line]
    assert len(lines) == 1
    assert lines[0].startswith(f"- [{number(path)}]({path.name}) ")
    found = status(path)
    how = {None: "", "superseded": "superseded by", "accepted, in part superseded": "in part superseded by"}
    says = re.search(r"\((in part superseded by|superseded by) (\d+)\)$", lines[0])
    assert (says[1] if says else "") == how[found["how"]]
    assert (says[2] if says else None) == found["n"]


def test_the_index_names_no_decision_that_is_not_there():
    named = re.findall(r"\]\((\d{4}-[^)]+)\)", INDEX)
    assert sorted(named) == [path.name for path in DECISIONS]
