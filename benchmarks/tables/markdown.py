"""Tables as docs/results.md shows them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


def table(title: str, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table under its title."""
    lines = [columns, ["---"] * len(columns), *rows]
    body = "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)
    return f"{title}\n\n{body}\n"


def words(verdict: str) -> str:
    """Return a verdict without its underscore."""
    return verdict.replace("_", " ")
