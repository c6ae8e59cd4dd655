"""Which recordings of a command are of one valve, and their answers once they have been judged together."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agent.cli.diagnosing.answer import Answer

TAG_AND_DATE = re.compile(r"(?P<valve>(?:.*[^A-Za-z0-9])?[A-Z]{2,4}\d{3,}[A-Z]?)[_-]\d[\dTZ:.+_-]*")
"""Stem of a recording that names its valve: a tag as ISA-5.1 has it (FIC20102, PIC101B), maybe with the
plant's unit before it, and a number or a date: ``2411_FIC20102_40``, ``TIC101-2026-03-01T0800``."""


def valve_of(recording: Path) -> tuple[Path, str] | None:
    """Return folder and tag of a recording; None where its name has no tag with a number or a date behind."""
    found = TAG_AND_DATE.fullmatch(recording.stem)
    return None if found is None else (recording.parent, found["valve"])


def valves(recordings: Sequence[Path], *, each: bool, one_valve: bool) -> list[int]:
    """Return for each recording the index of the first one of the same valve, maybe its own.

    Args:
        recordings: Files, in the order in which they were given.
        each: Every recording is taken alone.
        one_valve: All are of one valve, whatever their names.
    """
    if each:
        return list(range(len(recordings)))
    if one_valve:
        return [0] * len(recordings)
    first: dict[tuple[Path, str], int] = {}
    names = [valve_of(path) for path in recordings]
    return [k if name is None else first.setdefault(name, k) for k, name in enumerate(names)]


def together(answers: Iterator[Answer], valve: Sequence[int]) -> Iterator[Answer]:
    """Yield the answers in the same order, each once all those of its valve are there.

    Args:
        answers: One for each recording.
        valve: Of each recording, from ``valves``.
    """
    places: dict[int, list[int]] = {}
    for k, number in enumerate(valve):
        places.setdefault(number, []).append(k)
    come: list[Answer] = []
    said = 0
    for k, answer in enumerate(answers):
        come.append(answer)
        own = places[valve[k]]
        if own[-1] == k:
            _judge(own, come)
        while said < len(come) and places[valve[said]][-1] < len(come):
            yield come[said]
            come[said] = replace(
                come[said], found=None, diagnosis=None, window=None, shown=None
            )  # they are done with
            said += 1


def _judge(places: Sequence[int], come: list[Answer]) -> None:
    """Put the answers of one valve, at ``places``, in view of each other."""
    known = [
        (k, answer.shown, answer.diagnosis, answer.found)
        for k, answer in ((k, come[k]) for k in places)
        if answer.shown is not None and answer.diagnosis is not None and answer.found is not None
    ]
    if len(known) < 2:
        return
    from agent.analysis.one_valve import judged_together
    from agent.cli.common.pictures import draw
    from agent.cli.diagnosing.answer import printed_of

    judged = judged_together([each[1] for each in known], [each[2] for each in known])
    for (k, window, alone, shown), diagnosis in zip(known, judged, strict=True):
        task, faults, picture = come[k].task, come[k].faults, come[k].task.picture
        if picture is not None and diagnosis.verdict != alone.verdict:
            faults = draw(window, diagnosis, picture)  # its title says the verdict
        found = printed_of(task, diagnosis, shown.finding.quality, shown.finding.thumbnail)
        come[k] = replace(come[k], found=found, diagnosis=diagnosis, faults=faults)
