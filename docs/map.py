"""Write "Where things live" of the architecture page and the README from the docstrings of the packages.

``python -m docs.map`` writes both tables between their marks; a test compares them with the tree.
"""
# ruff: noqa: INP001 - a script beside the pages that it writes, no package

from __future__ import annotations

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
SOURCES = ("agent", "connectors", "simulators", "benchmarks")
BEGIN, END = "<!-- map: written by `python -m docs.map` -->", "<!-- end of map -->"
DEPTH_OF_README = 2
"""Packages of the README: those of the top and one below; the page on architecture has all."""
ALL = 99
PAGES = {"README.md": DEPTH_OF_README, "docs/architecture.md": ALL}
"""Page to the depth of its table."""


def packages() -> dict[str, str]:
    """Return the folder of each package and the first line of its docstring, in the order of the tree."""
    found = {}
    for source in SOURCES:
        for file in sorted((ROOT / source).rglob("__init__.py")):
            text = ast.get_docstring(ast.parse(file.read_text(encoding="utf-8"))) or ""
            folder = file.parent.relative_to(ROOT).as_posix()
            found[folder] = text.split("\n", 1)[0].replace("``", "`")
    return found


def table(depth: int) -> str:
    """Return the table of all packages at most ``depth`` folders deep."""
    rows = [f"| `{folder}` | {line} |" for folder, line in packages().items() if folder.count("/") < depth]
    return "\n".join(["| package | what it does |", "|---|---|", *rows])


def written(text: str, depth: int) -> str:
    """Return a page's ``text`` with the table between its marks as it is now."""
    before, rest = text.split(BEGIN)
    after = rest.split(END)[1]
    return f"{before}{BEGIN}\n\n{table(depth)}\n\n{END}{after}"


def main() -> None:
    """Write the tables of all pages."""
    for name, depth in PAGES.items():
        page = ROOT / name
        page.write_text(written(page.read_text(encoding="utf-8"), depth), encoding="utf-8")


if __name__ == "__main__":
    main()
