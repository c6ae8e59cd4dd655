"""Which tag is of which loop and role: recognised, by a pattern, or by a list."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import TYPE_CHECKING

from connectors.exports.cells.tag_roles import ROLE, TagRole, plain, tag_role
from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
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
