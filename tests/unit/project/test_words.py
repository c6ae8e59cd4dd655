"""Plain words (`docs/glossary.md`): the counts of words that are not to be written may only fall.

Whoever lowers a count lowers its bound here, too.
"""

import io
import re
import tokenize
from functools import cache
from pathlib import Path

import pytest
from typer.main import get_command

from agent.cli.commands import app

ROOT = Path(__file__).parents[3]
FORBIDDEN = re.compile(
    r"\b(?:tell|tells|told|telling|ask|asks|asked|asking|outdo|outdoes|outdone|what is left)\b", re.IGNORECASE
)

BOUNDS: dict[str, int] = {}
"""Largest number of such words in a place. It may be lowered, never raised."""
HELP_BOUND = 0
"""The same for the help of all commands together."""


def words_of(path: Path) -> str:
    """Return the prose of a file: all of a page, strings and comments of a module."""
    text = path.read_text(encoding="utf-8")
    if path.suffix != ".py":
        return text
    kept = (tokenize.STRING, tokenize.COMMENT)
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return "\n".join(token.string for token in tokens if token.type in kept)


def place_of(path: Path) -> str:
    """Return the key of `BOUNDS` that a file belongs to: its folder, two deep at most."""
    folders = path.relative_to(ROOT).parts[:-1]
    return "/".join(folders[:2]) or path.name


@cache
def files_of() -> dict[str, list[Path]]:
    """Return place -> its files; they are read by the tests, not when tests are collected."""
    files = [
        ROOT / "README.md",
        ROOT / "CHANGELOG.md",
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "config").rglob("*.yaml"),
        *(
            path
            for package in ("agent", "connectors", "simulators")
            for path in (ROOT / package).rglob("*.py")
        ),
    ]
    places: dict[str, list[Path]] = {}
    for path in files:
        name = str(path.relative_to(ROOT))
        if name != "docs/glossary.md":
            places.setdefault(place_of(path), []).append(path)
    return places


def help_texts(command, path: tuple[str, ...] = ()) -> dict[str, str]:
    """Return each command's own words: its help and that of each option."""
    own = [command.help or "", command.epilog or ""]
    own += [getattr(parameter, "help", None) or "" for parameter in command.params]
    texts = {" ".join(path): "\n".join(own)}
    for name, child in getattr(command, "commands", {}).items():
        texts |= help_texts(child, (*path, name))
    return texts


@pytest.mark.parametrize("place", sorted(files_of()))
def test_the_words_that_are_not_to_be_written_grow_fewer(place):
    count = sum(len(FORBIDDEN.findall(words_of(path))) for path in files_of()[place])
    assert count <= BOUNDS.get(place, 0), f"{place}: write as docs/glossary.md has it"


def test_no_bound_is_left_of_a_place_that_has_gone():
    assert set(BOUNDS) <= set(files_of())


def test_help_is_written_in_the_words_of_the_glossary():
    texts = help_texts(get_command(app))
    assert len(texts) > 10
    found = {command: FORBIDDEN.findall(text) for command, text in texts.items() if FORBIDDEN.search(text)}
    assert sum(map(len, found.values())) <= HELP_BOUND, found
