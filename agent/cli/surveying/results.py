"""The results of a survey as files, and in one sentence."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from agent.cli.diagnosing.one_valve import valve_of
from agent.counted import counted
from agent.report.fleet.of_survey import survey_rows
from agent.report.fleet.page import fleet_html
from agent.report.ranking import GROUPS
from agent.runtime.survey.parquet import write_parquet

if TYPE_CHECKING:
    from agent.report.fleet.rows import ValveRow
    from agent.runtime.survey.ledger import Ledger
    from agent.runtime.survey.survey import SurveySummary

TABLE, PAGE = "survey.parquet", "survey.html"


def write_results(folder: Path, ledger: Ledger, summary: SurveySummary) -> list[ValveRow]:
    """Write table and page of what is done; return the ranking.

    Raises:
        OSError: A file cannot be written.
        StoreError: The ledger cannot be read.
    """
    write_parquet(folder / TABLE, ledger.rows)
    rows = survey_rows(ledger.findings, _valve)
    page = fleet_html(rows, f"Survey: {folder.absolute().name}", (*summary.faults, *summary.problems))
    part = folder / f"{PAGE}.part"
    part.write_text(page, encoding="utf-8")
    part.replace(folder / PAGE)
    return rows


def survey_words(folder: Path, rows: Sequence[ValveRow], summary: SurveySummary) -> str:
    """Return what was found in one sentence, and where it is."""
    counts = Counter(row.group for row in rows)
    found = ", ".join(f"{counts[group]} {words.lower()}" for group, words in GROUPS.items() if counts[group])
    recordings = sum(len(row.findings) for row in rows)
    earlier = f", {summary.resumed} of them by an earlier run" if summary.resumed else ""
    failed = f"; not read: {len(summary.faults)}" if summary.faults else ""
    size = f"{counted(recordings, 'recording')} of {counted(len(rows), 'valve')}"
    return f"{size}{earlier}: {found or 'nothing'}{failed}; {folder / TABLE}, {folder / PAGE}"


def _valve(recording: str, loop: str) -> Hashable:
    """Return what recordings of one valve share: folder and tag as of `diagnose`, else nothing."""
    tag = valve_of(Path(recording).with_name(f"{loop}.csv"))
    return (recording, loop) if tag is None else tag
