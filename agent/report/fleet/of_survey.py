"""The ranking of a survey: all loops compared, pictures of the most urgent only."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import replace
from typing import Any

from agent.report.fleet.rows import RecordFinding, ValveRow, valve_rows
from agent.report.fleet.stored_finding import finding_from

PICTURES = 300
"""Valves that have a small picture: 7 kB each, and nobody looks at the five-thousandth."""
Stored = Mapping[str, Any]


def survey_rows(
    findings: Callable[[], Iterator[Stored]], valve_of: Callable[[str, str], Hashable]
) -> list[ValveRow]:
    """Return one row for each valve, the most urgent first.

    Args:
        findings: Gives all findings as JSON (`stored_finding`); called twice, for pictures are large.
        valve_of: Recording and loop -> what all recordings of one valve share.
    """
    known = [finding_from({**each, "thumbnail": None}) for each in findings()]
    numbers: dict[Hashable, int] = {}
    valve = [numbers.setdefault(valve_of(each.recording, each.loop), len(numbers)) for each in known]
    rows = valve_rows(known, valve, [each.loop for each in known])
    shown = {_key(row.lead.recording, row.lead.loop) for row in rows[:PICTURES]}
    pictures = {
        _key(each["recording"], each["loop"]): finding_from(each)
        for each in findings()
        if _key(each["recording"], each["loop"]) in shown
    }
    return [replace(row, lead=_with_picture(row.lead, pictures)) for row in rows]


def _key(recording: str, loop: str) -> tuple[str, str]:
    return recording, loop


def _with_picture(lead: RecordFinding, pictures: Mapping[tuple[str, str], RecordFinding]) -> RecordFinding:
    return pictures.get(_key(lead.recording, lead.loop), lead)
