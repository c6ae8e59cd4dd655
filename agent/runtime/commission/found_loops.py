"""Loops that were found by the names of their tags, wherever these are."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from agent.settings.tag_names import NamedTag, TagGroup, groups_by_convention, groups_by_pattern

Patterns = Mapping[str, str]
"""Role -> name with one ``*``; empty: the names of common control systems."""


@dataclass(frozen=True, slots=True)
class FoundLoop:
    """A loop, as its server or broker has it."""

    name: str
    by: str
    """Control system whose names match, or the pattern that found it."""
    tags: Mapping[str, Mapping[str, object]]
    """Role -> where its value is, as in a configuration."""
    values: Mapping[str, object]
    """Role -> the value, where that is not bad."""
    spans: Mapping[str, tuple[float, float]]
    """Role -> range of its values, where the server has one."""

    def entry(self, connection: str, ts: float) -> dict[str, object]:
        """Return its entry in a configuration."""
        ranges = {f"{role}_range": list(self.spans[role]) for role in ("op", "pv") if role in self.spans}
        tags = {role: dict(tag) for role, tag in self.tags.items()}
        return {"name": self.name, "connection": connection, "ts": ts, **ranges, "tags": tags}


@dataclass(frozen=True, slots=True)
class LoopSearch:
    """What a search found."""

    loops: tuple[FoundLoop, ...]
    nodes: int
    """Nodes, or topics, that were seen."""
    variables: int
    """Variables of these, or values in their messages."""
    stopped: str | None
    """The bound that ended it; None where all was seen."""
    called: tuple[str, str] = ("nodes", "variables")
    """What these are."""


def groups_of(tags: Iterable[NamedTag], patterns: Patterns | None) -> tuple[TagGroup, ...]:
    """Return the loops among tags."""
    return groups_by_pattern(tags, patterns) if patterns else groups_by_convention(tags)


def found_loops(
    groups: Iterable[TagGroup],
    tags: Mapping[str, Mapping[str, object]],
    held: Mapping[str, object],
    spans: Mapping[str, tuple[float, float]],
) -> tuple[FoundLoop, ...]:
    """Return the loops whose PV and OP may be numbers.

    Args:
        groups: Of tags.
        tags: Address of a tag -> its entry in a configuration.
        held: Address -> its value, where that is not bad.
        spans: Address -> range of its values, where there is one.
    """
    return tuple(_found(each, tags, held, spans) for each in groups if _is_numeric(each, held))


def _found(
    group: TagGroup,
    tags: Mapping[str, Mapping[str, object]],
    held: Mapping[str, object],
    spans: Mapping[str, tuple[float, float]],
) -> FoundLoop:
    places = {role: tag.address for role, tag in group.tags.items()}
    return FoundLoop(
        group.name,
        group.by,
        {role: tags[place] for role, place in places.items()},
        {role: held[place] for role, place in places.items() if place in held},
        {role: spans[place] for role, place in places.items() if place in spans},
    )


def _is_numeric(group: TagGroup, held: Mapping[str, object]) -> bool:
    """Whether PV and OP may be numbers; those without a value may."""
    found = [held.get(group.tags[role].address) for role in ("pv", "op")]
    return all(
        each is None or (isinstance(each, int | float) and not isinstance(each, bool)) for each in found
    )
