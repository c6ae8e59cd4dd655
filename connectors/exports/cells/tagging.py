"""Which tag is of which loop and role: recognised, by a pattern, or by a list."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

from connectors.exports.cells.instrument_tags import instrument_role
from connectors.exports.cells.tag_roles import ROLE, TagRole, plain, tag_role
from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from connectors.exports.recorded import ReadOptions

Tagger = Callable[[str], TagRole | None]


def tagger_of(path: Path, options: ReadOptions) -> Tagger:
    """Return what takes a tag apart.

    Raises:
        RecordingError: The pattern lacks ``{loop}`` or ``{role}``.
    """
    if options.loops:
        return _by_list(options.loops)
    if options.pattern is None:
        return tag_role
    if "{loop}" not in options.pattern or "{role}" not in options.pattern:
        raise RecordingError(
            f"{path}: expected a pattern with {{loop}} and {{role}}, found {options.pattern!r}"
        )
    form = (
        re.escape(options.pattern).replace(r"\{loop\}", "(?P<loop>.+)").replace(r"\{role\}", "(?P<role>.+)")
    )
    compiled = re.compile(form.replace(r"\*", ".*"), re.IGNORECASE)

    def by_pattern(tag: str) -> TagRole | None:
        found = compiled.fullmatch(tag.strip())
        role = None if found is None else ROLE.get(plain(found["role"]))
        return None if found is None or role in {None, "quality"} else TagRole(found["loop"], str(role))

    return by_pattern


def _by_list(loops: Mapping[str, Mapping[str, str]]) -> Tagger:
    """Return what knows the tags of a list, loop -> role -> tag, and the qualities of these tags."""
    known = {tag: TagRole(loop, role.lower()) for loop, roles in loops.items() for role, tag in roles.items()}
    named = {(found.loop, found.role): tag for tag in known if (found := tag_role(tag)) is not None}

    def by_list(tag: str) -> TagRole | None:
        found = None if tag in known else tag_role(tag)
        if found is None or not found.of_quality:
            return known.get(tag)
        own = named.get((found.loop, found.role))
        return None if own is None else replace(known[own], of_quality=True)

    return by_list


def suited(tagger: Tagger, names: Iterable[str]) -> Tagger:
    """Return a tagger, or where words for roles make no loop of names, the letters of instruments do.

    Names with words for roles are surer: ``FT-211`` beside ``FIC211.PV`` and ``FIC211.OP`` is no second loop.
    """
    known = list(names)
    by_words = tagger is not tag_role or complete_loops(tag_role, known)
    return tagger if by_words or not complete_loops(instrument_role, known) else instrument_role


def complete_loops(tagger: Tagger, names: Iterable[str]) -> int:
    """Return how many loops names make that have PV and an output."""
    roles = defaultdict[str, set[str]](set)
    for name in names:
        found = tagger(name)
        if found is not None and found.loop and not found.of_quality:
            roles[found.loop].add(found.role)
    return sum("pv" in each and bool(each & {"op", "mv"}) for each in roles.values())
