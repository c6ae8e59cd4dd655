"""Effects of installed packages that can be used, and a line for each that cannot.

An effect that cannot be imported or breaks its contract must not stop the work with all others.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path

from agent.checks.contract import ContractError
from agent.checks.effects import LOADED
from agent.physics.effect import Effect
from agent.physics.effects import EFFECTS, ENTRY_POINTS
from agent.physics.foreign import file_of


@dataclass(frozen=True, slots=True)
class Usable:
    """What ``usable_effects`` found."""

    effects: tuple[Effect, ...]
    """Built in, then those of installed packages that keep their contract."""
    left_out: tuple[str, ...]
    """A line for each that does not: effect, file, and what its contract demands."""


def usable_effects(files: Iterable[str] = ()) -> Usable:
    """Return the effects built in, of installed packages and of files that pass ``effects.LOADED``.

    Args:
        files: ``plant_effects.py:SplitRange``, a class in a file. Its folder joins the places from which
            Python imports, so that the processes that fit find it too.
    """
    known = {each.name: each for each in EFFECTS}
    left_out = []
    for entry in (*entry_points(group=ENTRY_POINTS), *map(_entry_of_file, files)):
        try:
            effect = _loaded(entry)
        except ContractError as error:
            left_out.append(f"{error}; it is left out")
            continue
        if effect.name in known:
            subject = f"effect {effect.name} ({file_of(effect)})"
            left_out.append(f"{subject} must have a name that no other effect has; it is left out")
            continue
        known[effect.name] = effect
    return Usable(tuple(known.values()), tuple(left_out))


def _entry_of_file(file: str) -> EntryPoint:
    """Return a file and its class as an entry point of an installed package would have them."""
    path, _, name = file.rpartition(":")
    folder = str(Path(path).resolve().parent)
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return EntryPoint(name, f"{Path(path).stem}:{name}", ENTRY_POINTS)


def _loaded(entry: EntryPoint) -> Effect:
    """Return the effect that an entry point offers.

    Raises:
        ContractError: It cannot be imported or made, or breaks its contract.
    """
    try:
        effect: Effect = entry.load()()
    except Exception as error:  # the code of somebody else may raise anything
        found = f"{type(error).__name__}: {' '.join(str(error).split())}"
        demand = "must be a class that can be imported and called without arguments"
        raise ContractError(f"effect {entry.name} ({_file(entry)}) {demand}; {found}") from error
    for check in LOADED:
        check(effect)
    return effect


def _file(entry: EntryPoint) -> str:
    """Return the file of the module of an entry point; what the entry point says where it has none."""
    try:
        spec = find_spec(entry.module)
    except (ImportError, ValueError):
        spec = None
    return spec.origin if spec is not None and spec.origin is not None else entry.value
