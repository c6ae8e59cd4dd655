"""Where in a YAML file something stands: line and loop of a path such as ``loops.0.tags.pv``."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

import yaml

Steps: TypeAlias = list[str]
PATH = re.compile(r"(?P<path>[^:\s,]+): (?P<message>.*)", re.DOTALL)
"""A fault: a path, and what is wrong there."""
LOOP = re.compile(r"\bloops\.(\d+)\b")
NAMED = {"loops": "loop", "connections": "connection"}
"""Part of the file -> what one entry of it is."""


@dataclass(frozen=True, slots=True)
class Places:
    """The tree of a YAML file with its lines."""

    root: yaml.Node | None
    """None: the text is no YAML, and nothing has a line."""

    @classmethod
    def of(cls, text: str) -> Places:
        """Return the places of a file's text, of none where it is no YAML."""
        try:
            return cls(yaml.compose(text, Loader=yaml.SafeLoader))
        except (yaml.YAMLError, ValueError, RecursionError):
            return cls(None)

    def located(self, faults: Iterable[str]) -> list[str]:
        """Return faults with line and name of the loop or connection; those without a path as they are."""
        return [self._located(fault) for fault in faults]

    def line(self, *path: str) -> int | None:
        """Return the line of the deepest part of a path that the file has; None where it has nothing of it.

        A loop may be named by its place in the list or by its name.
        """
        node, line = self.root, None
        for key in path:
            found = _below(node, key)
            if found is None:
                break
            line, node = found
        return line

    def _located(self, fault: str) -> str:
        found = PATH.fullmatch(fault)
        if found is None:
            return fault
        steps = found["path"].split(".")
        line = self.line(*steps)
        if line is None or not self._has(steps[:2]):
            return fault  # of another file, or of a loop that comes from one
        message = LOOP.sub(lambda each: self._line_words(each[0].split(".")), found["message"])
        return f"line {line}: {self._words(steps)}: {message}"

    def _has(self, steps: Steps) -> bool:
        """Whether the file has an entry: of agent and of what is no part of it the first step is enough."""
        return (
            steps[0] not in NAMED
            or len(steps) < 2
            or _below(_node(_below(self.root, steps[0])), steps[1]) is not None
        )

    def _words(self, steps: Steps) -> str:
        """Return ``loop FIC101: tags.pv`` for ``loops.0.tags.pv``."""
        if len(steps) < 2 or steps[0] not in NAMED:
            return ".".join(steps)
        return ": ".join(filter(None, [self._entry(steps), ".".join(steps[2:])]))

    def _entry(self, steps: Steps) -> str:
        """Return ``loop FIC101``, ``list loops.csv`` or ``connection dcs``; a loop may have only a number."""
        if steps[0] != "loops" or not steps[1].isdecimal():
            return f"{NAMED[steps[0]]} {steps[1]}"
        entry = _node(_below(_node(_below(self.root, "loops")), steps[1]))
        name, source = (_node(_below(entry, key)) for key in ("name", "from"))
        if isinstance(source, yaml.ScalarNode):
            return f"list {source.value}"
        return (
            f"loop {name.value}" if isinstance(name, yaml.ScalarNode) else f"loop number {int(steps[1]) + 1}"
        )

    def _line_words(self, steps: Steps) -> str:
        line = self.line(*steps)
        return ".".join(steps) if line is None else f"line {line}"


def _below(node: yaml.Node | None, key: str) -> tuple[int, yaml.Node] | None:
    """Return line and node of a key of a mapping, of a place in a list, or of the entry of that name."""
    if isinstance(node, yaml.MappingNode):
        for each, value in node.value:
            if isinstance(each, yaml.ScalarNode) and each.value == key:
                return each.start_mark.line + 1, value
        return None
    if not isinstance(node, yaml.SequenceNode):
        return None
    if key.isdecimal() and int(key) < len(node.value):
        entry = node.value[int(key)]
        return entry.start_mark.line + 1, entry
    for entry in node.value:
        name = _node(_below(entry, "name")) if isinstance(entry, yaml.MappingNode) else None
        if isinstance(name, yaml.ScalarNode) and name.value == key:
            return entry.start_mark.line + 1, entry
    return None


def _node(found: tuple[int, yaml.Node] | None) -> yaml.Node | None:
    return None if found is None else found[1]
