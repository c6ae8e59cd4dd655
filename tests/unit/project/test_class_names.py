"""A class name occurs once in the project: a reader who searches for it finds one class."""

import ast
from collections import defaultdict

from tests.conftest import ROOT

REPLACED = {
    # Both are insides of engines that one engine replaces (issue 26); their names go with them.
    "Fit": {"agent/analysis/innovations/whitened.py", "agent/workbench/fit.py"},
}
"""Names that occur twice for now, with their files. Entries may only go."""


def files_of_names() -> dict[str, list[str]]:
    """Return class name -> file of each class that has it, nested classes too."""
    found = defaultdict(list)
    for package in ("agent", "connectors", "simulators"):
        for path in sorted((ROOT / package).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    found[node.name].append(path.relative_to(ROOT).as_posix())
    return found


def test_a_class_name_occurs_once():
    twice = {name: files for name, files in files_of_names().items() if len(files) > 1}
    assert {name: set(files) for name, files in twice.items()} == REPLACED
    assert all(len(files) == len(set(files)) for files in twice.values())
