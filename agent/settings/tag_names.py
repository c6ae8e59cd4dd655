"""Groups tags into loops, by the names that control systems give them.

Upper and lower case are equal. One of ``/ . : # |`` or a space separates the words of a name; before the last
word also ``_`` or ``-``: ``Area1/FIC101/PID1/PV.CV``, ``FIC101.PIDA.OP``, ``FIC_101_PV``.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Convention:
    """Names that one family of control systems gives to the parts of a controller."""

    system: str
    pv: str
    op: str
    sp: str = ""
    mode: str = ""


CONVENTIONS = (
    Convention("DeltaV", "PV.CV", "OUT.CV", "SP.CV", "MODE.ACTUAL"),
    Convention("Experion, TDC 3000", "PV", "OP", "SP", "MODE"),
    Convention("PCS 7 APL", "PV.Value", "MV.Value", "SP.Value", "AutAct.Value"),
    Convention("PCS 7", "PV_IN", "LMN", "SP", "QMAN_AUT"),
    Convention("Logix PIDE", "PV", "CVEU", "SP", "AUTO"),
    Convention("Foxboro I/A", "MEAS", "OUT", "SPT", "MA"),
    Convention("ABB", "ME", "OUT", "SP", "MODE"),
    Convention("PV, CO", "PV", "CO", "SP", "MODE"),
    Convention("PV, CV", "PV", "CV", "SP", "MODE"),
    Convention("PV, OUT", "PV", "OUT", "SP", "MODE"),
    Convention("Centum", "PV", "MV", "SV", "MODE"),
    Convention("PV, MV", "PV", "MV", "SP", "MODE"),
    Convention("in words", "ProcessValue", "Output", "Setpoint", "Mode"),
    Convention("in words", "Measurement", "Output", "Setpoint", "Mode"),
    Convention("in words", "ProcessVariable", "ControllerOutput", "Setpoint", "Mode"),
)
"""The first match counts where a controller has tags of several. MV is OP only where nothing else is."""

_BLOCK = re.compile(
    r"PID([AE]|_?\d+)?|DACA|REGCTL[A-Z]?|CTRL|CONTROL(LER)?|LOOP|FBK?\d*|BLOCK\d*|VALUES?", re.IGNORECASE
)
"""Words between a loop's name and its PV that name the block, not the loop."""
_BETWEEN = re.compile(r"[/.:#|\s]")
_LAST = re.compile(r"[_-]")
ROLES = ("pv", "op", "sp", "mode")


@dataclass(frozen=True, slots=True)
class NamedTag:
    """A tag: its address and all its possible names, the best first."""

    address: str
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TagGroup:
    """Tags that belong to one loop."""

    name: str
    """Name of the loop, valid in the configuration and unique."""
    by: str
    """Convention or pattern that found it."""
    tags: Mapping[str, NamedTag] = field(default_factory=dict)
    """Role -> tag; pv and op at least."""


def groups_by_convention(
    tags: Iterable[NamedTag], conventions: Sequence[Convention] = CONVENTIONS
) -> tuple[TagGroup, ...]:
    """Return the loops among ``tags`` that follow a convention, in the order of their PV tags."""
    ends = _ends(conventions)
    found: dict[str, dict[tuple[int, str], NamedTag]] = defaultdict(dict)
    for tag in tags:
        for name in tag.names:
            matches = [(stem, place) for stem, end in _split(name) for place in ends.get(end.casefold(), ())]
            for stem, place in matches:
                found[stem].setdefault(place, tag)
            if matches:
                break
    chosen = []
    for stem, places in found.items():
        for index, convention in enumerate(conventions):
            members = {role: places[index, role] for role in ROLES if (index, role) in places}
            if {"pv", "op"} <= members.keys():
                chosen.append((stem, convention.system, members))
                break
    return _named(chosen)


def groups_by_pattern(tags: Iterable[NamedTag], patterns: Mapping[str, str]) -> tuple[TagGroup, ...]:
    """Return the loops whose tags match ``patterns``: role -> name with one ``*`` for the loop."""
    found: dict[str, dict[str, NamedTag]] = defaultdict(dict)
    for tag in tags:
        for role, pattern in patterns.items():
            before, _, after = pattern.casefold().partition("*")
            for name in tag.names:
                folded = name.casefold()
                if (
                    len(folded) > len(before) + len(after)
                    and folded.startswith(before)
                    and folded.endswith(after)
                ):
                    found[name[len(before) : len(name) - len(after)]].setdefault(role, tag)
                    break
    by = ", ".join(patterns.values())
    return _named([(stem, by, members) for stem, members in found.items() if {"pv", "op"} <= members.keys()])


def _ends(conventions: Sequence[Convention]) -> dict[str, list[tuple[int, str]]]:
    """Return end of a name -> its possible meanings: index of the convention and role."""
    ends: dict[str, list[tuple[int, str]]] = defaultdict(list)
    for index, convention in enumerate(conventions):
        for role in ROLES:
            end = getattr(convention, role).casefold()
            if end:
                ends[end].append((index, role))
    return ends


def _split(name: str) -> list[tuple[str, str]]:
    """Return the ways to split a name into a loop and an end of one or two words, longer ends first."""
    cuts = [match.start() for match in _BETWEEN.finditer(name)][-2:]
    ways = [(name[:cut], _BETWEEN.sub(".", name[cut + 1 :])) for cut in cuts]
    joints = [match.start() for match in _LAST.finditer(name, cuts[-1] + 1 if cuts else 0)]
    ways += [(name[:joint], name[joint + 1 :]) for joint in joints[-1:]]
    return [(stem, end) for stem, end in ways if stem and end]


def _named(chosen: Sequence[tuple[str, str, dict[str, NamedTag]]]) -> tuple[TagGroup, ...]:
    """Give each group a unique name: the loop's; with its block or its full path where several share it."""
    taken: set[str] = set()
    groups = []
    candidates = [_names(stem) for stem, _, _ in chosen]
    counts: dict[str, int] = defaultdict(int)
    for names in candidates:
        for name in dict.fromkeys(names):
            counts[name] += 1
    for (_, by, members), names in zip(chosen, candidates, strict=True):
        name = next((n for n in names if counts[n] == 1 and n not in taken), names[-1])
        number = 2
        while name in taken:
            name, number = f"{names[-1]}-{number}", number + 1
        taken.add(name)
        groups.append(TagGroup(name, by, members))
    return tuple(groups)


def _names(stem: str) -> list[str]:
    """Return three names of a loop: the shortest, that with its block, and that with its full path."""
    words = [word for word in _BETWEEN.split(stem) if word] or [stem]
    loop = len(words)
    while loop > 1 and _BLOCK.fullmatch(words[loop - 1]):
        loop -= 1
    ways = [words[loop - 1 : loop], words[loop - 1 :], words]
    return [re.sub(r"[\s/+#.]", "_", "-".join(way)) for way in ways]
