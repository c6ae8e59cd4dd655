"""Names that a user gives on the command line: effects, of his own as well, bases, inputs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from agent.cli.common.errors import complain

if TYPE_CHECKING:
    from agent.physics.effect import Effect


def usable(files: Iterable[str]) -> tuple[Effect, ...]:
    """Return the effects that may be tried; name each installed one that is left out, and why."""
    from agent.checks.plug_ins import usable_effects

    for file in files:
        path = Path(file.rpartition(":")[0])
        if path.suffix != ".py" or not path.is_file():
            words = f"{file}: expected FILE.py:CLASS, of a file that exists"
            raise typer.BadParameter(words, param_hint="--effect")
    found = usable_effects(files)
    for line in found.left_out:
        complain(line)
    return found.effects


def check_names(base: str, names: Iterable[str], effects: Sequence[Effect]) -> None:
    """Refuse what does not exist before anything is read."""
    from agent.workbench.library import base_named, effect_named
    from agent.workbench.session.auto_base import AUTO

    try:
        if base != AUTO:
            base_named(base)
        for name in names:
            effect_named(name, effects)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


def named_columns(words: Iterable[str]) -> dict[str, str]:
    """Return the column of each input by its name.

    Raises:
        BadParameter: One is not written NAME=COLUMN, or a name comes twice.
    """
    found: dict[str, str] = {}
    for word in words:
        name, _, column = word.partition("=")
        if not (name.isidentifier() and column) or name in found:
            raise typer.BadParameter(f"{word}: expected NAME=COLUMN, each name once", param_hint="--input")
        found[name] = column
    return found
