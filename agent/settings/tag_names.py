"""Which tags make a loop, by the names that control systems give them.

Capitals do not count. Between the words of a name stands one of ``/ . : # |`` or a space, before the last
also ``_`` or ``-``: ``Area1/FIC101/PID1/PV.CV``, ``FIC101.PIDA.OP``, ``FIC_101_PV``.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True, slots=True)
class Convention:
    """How one family of control systems calls the parts of a controller."""

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
"""Those named first win where a controller has tags of several. MV is OP only where nothing else is."""

_BLOCK = re.compile(
    r"PID([AE]|_?\d+)?|DACA|REGCTL[A-Z]?|CTRL|CONTROL(LER)?|LOOP|FBK?\d*|BLOCK\d*|VALUES?", re.IGNORECASE
)
"""Words between a loop's name and its PV that name the block, not the loop."""
_BETWEEN = re.compile(r"[/.:#|\s]")
_LAST = re.compile(r"[_-]")
ROLES = ("pv", "op", "sp", "mode")


@dataclass(frozen=True, slots=True)
class NamedTag:
    """A tag by its address and all the names that it may be known by, the best first."""

    address: str
    names: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TagGroup:
    """Tags that make a loop."""

    name: str
    """Of the loop, fit for the configuration, and no other of the same name."""
    by: str
    """The convention, or the pattern, that found it."""
    tags: Mapping[str, NamedTag] = field(default_factory=dict)
    """Role -> tag; pv and op at least."""


def groups_by_convention(
    tags: Iterable[NamedTag], conventions: Sequence[Convention] = CONVENTIONS
) -> tuple[TagGroup, ...]:
    """Return the loops among ``tags`` that follow a convention, in the order in which their PV comes."""
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
    """Return the loops whose tags fit ``patterns``, role -> name with one ``*`` that stands for the loop."""
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
    """Return the end of a name -> the places it may have: index of the convention and role."""
    ends: dict[str, list[tuple[int, str]]] = defaultdict(list)
    for index, convention in enumerate(conventions):
        for role in ROLES:
            end = getattr(convention, role).casefold()
            if end:
                ends[end].append((index, role))
    return ends


def _split(name: str) -> list[tuple[str, str]]:
    """Return the ways to part a name into that of a loop and an end of one word or two, longer ends first."""
    cuts = [match.start() for match in _BETWEEN.finditer(name)][-2:]
    ways = [(name[:cut], _BETWEEN.sub(".", name[cut + 1 :])) for cut in cuts]
    joints = [match.start() for match in _LAST.finditer(name, cuts[-1] + 1 if cuts else 0)]
    ways += [(name[:joint], name[joint + 1 :]) for joint in joints[-1:]]
    return [(stem, end) for stem, end in ways if stem and end]


def _named(chosen: Sequence[tuple[str, str, dict[str, NamedTag]]]) -> tuple[TagGroup, ...]:
    """Give each a name of its own: the loop's, with its block or with all above it where several share it."""
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
    """Return the shortest name of a loop, that with its block, and that with all above it."""
    words = [word for word in _BETWEEN.split(stem) if word] or [stem]
    loop = len(words)
    while loop > 1 and _BLOCK.fullmatch(words[loop - 1]):
        loop -= 1
    ways = [words[loop - 1 : loop], words[loop - 1 :], words]
    return [re.sub(r"[\s/+#.]", "_", "-".join(way)) for way in ways]
