"""What historians and databases share: tags with values in a span of time, from which loops are made."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import defaultdict
from collections.abc import Iterable, Mapping
from math import isfinite
from pathlib import Path

from connectors.exports.cells.tagging import suited, tagger_of
from connectors.exports.fault import RecordingError
from connectors.exports.layout import short_names, usable_roles
from connectors.exports.merged import merged
from connectors.exports.recorded import ReadOptions, RecordedLoop
from connectors.exports.tables.sheet import Sheet
from connectors.sources.collected import CollectedTag
from connectors.sources.source import Closing, Held

SHOWN = 10
"""Names that a message lists."""


class TagSource(Closing, ABC):
    """A source whose loops are recognised by the names of its tags, or named by a mapping."""

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is connected yet.

        Raises:
            RecordingError: The span is missing.
        """
        if options.span is None or not all(map(isfinite, options.span)):
            raise RecordingError(f"{name}: expected the span to read: name it by --start and --end")
        self.name = name
        self.options = options
        self.start, self.end = options.span
        """s UTC."""
        self._roles: dict[str, dict[str, str]] = {}
        self._held: Held | None = None

    @abstractmethod
    def tags(self) -> Iterable[str]:
        """Yield the names of the tags that the source has."""

    @abstractmethod
    def collect(self, wanted: Mapping[str, CollectedTag]) -> None:
        """Read the values of some tags from ``start`` up to ``end``, which does not count.

        Raises:
            ConfigError: They cannot be read; the text names source and tag.
        """

    def loops(self) -> Held:
        """Return the names of the loops."""
        if self._held is None:
            self._held = self._found()
        return self._held

    def read(self, loop: str) -> RecordedLoop:
        """Return one loop."""
        held = self.loops()
        if loop not in self._roles:
            names = ", ".join(held.loops[:SHOWN])
            raise RecordingError(f"{self.name}: has no loop {loop!r}, it holds: {names}")
        tags = self._roles[loop]
        wanted = {
            tag: CollectedTag(f"{self.name}: tag {tag}", mode=role == "mode") for role, tag in tags.items()
        }
        self.collect(wanted)
        empty = [tags[role] for role in ("pv", "op") if not len(wanted[tags[role]])]
        if empty:
            raise RecordingError(f"{self.name}: tag {empty[0]} of {loop} has no value in the span")
        sheet = Sheet(Path(self.name), (), (), "value", 0, "values")
        series = {role: wanted[tag].series() for role, tag in tags.items() if len(wanted[tag])}
        labels = {role if role == "mode" else role.upper(): tag for role, tag in tags.items()}
        bad = sum(each.bad for each in wanted.values())
        return merged(sheet, loop, series, labels, bad, None)

    def version(self) -> str:
        """Return the span: what a historian holds of the past stays."""
        return f"{self.start} {self.end}"

    def _found(self) -> Held:
        given = [tag for roles in self.options.loops.values() for tag in roles.values()]
        tags = given or list(self.tags())
        tagger = suited(tagger_of(Path(self.name), self.options), tags)
        loops: dict[str, dict[str, str]] = defaultdict(dict)
        others: list[str] = []
        for tag in tags:
            found = tagger(tag)
            if found is None or not found.loop or found.of_quality:
                others.append(tag)
            else:
                loops[found.loop].setdefault(found.role, tag)
        problems = []
        if others:
            shown = ", ".join(others[:SHOWN])
            problems.append(f"{self.name}: {len(others)} tags of no loop were left out: {shown}")
        names = short_names(list(loops))
        for loop, own in loops.items():
            usable = usable_roles(own)
            lacking = [role.upper() for role in ("pv", "op") if role not in usable]
            if lacking:
                without = " and no ".join(lacking)
                problems.append(f"{self.name}: {names[loop]}: has no {without}, it was left out")
            else:
                self._roles[names[loop]] = usable
        if not self._roles:
            seen = f" ({problems[0]})" if problems else " (no tag was found)"
            expected = "expected tags of a loop, such as FIC101.PV and FIC101.OP"
            raise RecordingError(f"{self.name}: {expected}{seen}")
        return Held(tuple(self._roles), tuple(problems))
