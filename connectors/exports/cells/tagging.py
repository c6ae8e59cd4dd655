"""Which tag is of which loop and role: recognised, by a pattern, or by a list."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable
from typing import TYPE_CHECKING

from connectors.exports.cells.instrument_tags import instrument_role
from connectors.exports.cells.tag_roles import ROLE, TagRole, plain, tag_role
from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from connectors.exports.recorded import ReadOptions

Tagger = Callable[[str], TagRole | None]


def tagger_of(path: Path, options: ReadOptions) -> Tagger:
    """Return what takes a tag apart.

    Raises:
        RecordingError: The pattern lacks ``{loop}`` or ``{role}``.
    """
    if options.loops:
        known = {
            tag: TagRole(loop, role.lower())
            for loop, roles in options.loops.items()
            for role, tag in roles.items()
        }
        return known.get
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


def suited(tagger: Tagger, names: Iterable[str]) -> Tagger:
    """Return a tagger, or where words for roles make no loop of names, the letters of instruments do.

    Names with words for roles are surer: ``FT-211`` beside ``FIC211.PV`` and ``FIC211.OP`` is no second loop.
    """
    known = list(names)
    by_letters = tagger is tag_role and not _has_loop(tag_role, known) and _has_loop(instrument_role, known)
    return instrument_role if by_letters else tagger


def _has_loop(tagger: Tagger, names: Iterable[str]) -> bool:
    """Whether names make a loop with PV and an output."""
    roles = defaultdict[str, set[str]](set)
    for name in names:
        found = tagger(name)
        if found is not None and found.loop and not found.of_quality:
            roles[found.loop].add(found.role)
    return any("pv" in each and each & {"op", "mv"} for each in roles.values())
