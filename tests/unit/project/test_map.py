"""The map of the project cannot go stale: packages, ten questions of a newcomer, sizes of rooms and files."""

import ast
import re

import pytest

from docs.map import PAGES, packages, written
from tests.conftest import ROOT

ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
ANSWERS = re.search(r"## Where is \.\.\. done\n(.*?)(?=\n## |\Z)", ARCHITECTURE, re.DOTALL)[1]
ANSWER = re.compile(r"\[`([\w.]+)`\]\(\.\./([^)]+\.py)\)")
QUESTIONS = 10

MOST_FILES = 15
REGISTRIES = {
    "agent/analysis/stiction": "a file for each stiction detector",
    "agent/physics/effects": "a file for each effect",
    "agent/physics/valves": "a file for each stiction law",
    "agent/plots/detectors": "a file for each stiction detector",
    "benchmarks": "a file for each benchmark",
}
"""Packages whose members are files, with the reason why they may have more."""
TO_BE_DIVIDED = {"agent/analysis/quantify/free_run": 23, "agent/workbench": 34}
"""Packages that are too large: one engine replaces the first two, the third needs rooms.

Bounds may only fall."""

LONGEST = 300
LONG_FILES = {
    "agent/physics/valves/damped_stem.py": 400,  # one compiled kernel
}
"""Lines that a longer file may have: these bounds may only fall."""


@pytest.mark.parametrize("name", PAGES)
def test_where_things_live_is_the_tree(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    assert written(text, PAGES[name]) == text, "run python -m docs.map"


def test_every_package_says_in_one_line_what_it_does():
    assert [folder for folder, line in packages().items() if not line.endswith((".", ":"))] == []


def defined(path):
    """Names of functions, classes and their methods in a module."""
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    kinds = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)
    names = set()
    for node in tree.body:
        if isinstance(node, kinds):
            names.add(node.name)
            names |= {
                f"{node.name}.{each.name}" for each in getattr(node, "body", ()) if isinstance(each, kinds)
            }
    return names


def test_each_of_the_ten_questions_has_an_answer():
    rows = [line for line in ANSWERS.splitlines() if line.startswith("| ") and "---" not in line][1:]
    assert len(rows) == QUESTIONS
    assert [row for row in rows if not ANSWER.search(row)] == []


@pytest.mark.parametrize(("name", "path"), ANSWER.findall(ANSWERS))
def test_what_an_answer_names_is_defined_in_its_file(name, path):
    assert name in defined(path)


@pytest.mark.parametrize("folder", packages())
def test_a_room_holds_fifteen_files_at_most(folder):
    files = len([path for path in (ROOT / folder).glob("*.py") if path.name != "__init__.py"])
    if folder not in REGISTRIES:
        assert files <= TO_BE_DIVIDED.get(folder, MOST_FILES)


def test_no_file_is_longer_than_three_hundred_lines():
    files = [
        path
        for top in ("agent", "connectors", "simulators", "benchmarks", "tests", "docs")
        for path in (ROOT / top).rglob("*.py")
    ]
    lines = {
        path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8").count("\n") for path in files
    }
    assert {name: n for name, n in lines.items() if n > LONG_FILES.get(name, LONGEST)} == {}


def test_exceptions_name_what_is_there():
    assert [name for name in (*REGISTRIES, *TO_BE_DIVIDED, *LONG_FILES) if not (ROOT / name).exists()] == []
