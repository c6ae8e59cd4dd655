"""No file imports itself through others: each can be read, and moved, with what is below it alone.

Imports for types and within functions count too: a reader follows them all the same.
"""

import ast
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
PACKAGES = ("agent", "connectors", "simulators")
ALLOWED: dict[frozenset[str], str] = {}
"""Circles that stand, as the files that are in them, each with its reason."""


def modules(root):
    """Return the file of each module under ``root`` by its dotted name."""
    found = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            parts = path.relative_to(root).with_suffix("").parts
            found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imported(path, known):
    """Return the modules among ``known`` that a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            whole = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= whole & known
            if whole - known:
                found.add(node.module)
    return found & known


def graph(root):
    """Return what each module imports, by its name."""
    files = modules(root)
    return {name: imported(path, set(files)) - {name} for name, path in files.items()}


def circles(graph):
    """Return the groups of modules that import each other, directly or through others (Tarjan 1972)."""
    index, low, stack, found = {}, {}, [], []

    def visit(name):
        index[name] = low[name] = len(index)
        stack.append(name)
        for other in sorted(graph[name]):
            if other not in index:
                visit(other)
                low[name] = min(low[name], low[other])
            elif other in stack:
                low[name] = min(low[name], index[other])
        if low[name] == index[name]:
            group = stack[stack.index(name) :]
            del stack[stack.index(name) :]
            if len(group) > 1:
                found.append(frozenset(group))

    for name in graph:
        if name not in index:
            visit(name)
    return found


def test_no_file_imports_itself_through_others():
    standing = [sorted(each) for each in circles(graph(ROOT)) if each not in ALLOWED]
    assert not standing, f"files that import each other: {standing}"


def test_every_allowed_circle_is_there_still():
    assert set(ALLOWED) <= set(circles(graph(ROOT)))


@pytest.mark.parametrize(
    "last",
    [
        "from agent.first import ONE",
        "import agent.first",
        "from agent import first",
        "if TYPE_CHECKING:\n    from agent.first import ONE",
        "def late():\n    from agent.first import ONE",
    ],
)
def test_a_circle_is_found_however_it_is_closed(tmp_path, last):
    files = {
        "__init__": "",
        "first": "from agent.second import TWO",
        "second": "import agent.third",
        "third": last,
        "fourth": "from agent.first import ONE",
    }
    (tmp_path / "agent").mkdir()
    for name, text in files.items():
        (tmp_path / "agent" / f"{name}.py").write_text(text, encoding="utf-8")
    found = graph(tmp_path)
    assert circles(found) == [frozenset({"agent.first", "agent.second", "agent.third"})]
    with pytest.raises(CycleError):
        TopologicalSorter(found).prepare()
