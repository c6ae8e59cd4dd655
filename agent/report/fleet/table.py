"""The list of valves as a table for a terminal, and as CSV."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING

from agent.analysis.indices import INDICES
from agent.counted import counted
from agent.report.fleet.quality_words import quality_words, record_instead
from agent.report.numbers import value_words

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from agent.report.fleet.rows import RecordFinding, ValveRow

HEADER = ("", "valve", "records", "verdict", "P", "S (90 %)", "why", "next")


LONGEST = 48
"""Characters of the last two columns of the table."""
SHORTEST = 24
"""Where a terminal leaves less to each of these two, they get a line of their own below the row."""
GAP = "  "


def fleet_lines(rows: Sequence[ValveRow], width: int | None = None) -> Iterator[str]:
    """Yield the table, the most urgent valve first; ``width``: characters of a line, None: no limit."""
    yield f"{size_words(rows)}, the most urgent first"
    cells = [HEADER, *(_cells(number, each) for number, each in enumerate(rows, 1))]
    fixed = [max(len(row[k]) for row in cells) for k in range(len(HEADER) - 2)]
    used = sum(fixed) + len(GAP) * (len(fixed) + 1)
    room = LONGEST if width is None else min(LONGEST, (width - used) // 2)
    if width is not None and room < SHORTEST:
        yield from _narrow(cells, fixed, width)
        return
    words = max(len(_short(row[-2], room)) for row in cells)
    for row in cells:
        columns = [f"{cell:{size}}" for cell, size in zip(row[:-2], fixed, strict=True)]
        yield GAP.join((*columns, f"{_short(row[-2], room):{words}}", _short(row[-1], room))).rstrip()


def _narrow(cells: Sequence[Sequence[str]], fixed: Sequence[int], width: int) -> Iterator[str]:
    """Yield the table with why and next below each row."""
    indent = " " * (fixed[0] + len(GAP))
    for k, row in enumerate(cells):
        columns = [f"{cell:{size}}" for cell, size in zip(row[:-2], fixed, strict=True)]
        yield GAP.join(columns).rstrip()[:width]
        for name, words in zip(HEADER[-2:], row[-2:], strict=True):
            if k and words:
                yield _short(f"{indent}{name}: {words}", width)


def size_words(rows: Sequence[ValveRow]) -> str:
    """Return how many valves and recordings there are."""
    recordings = sum(len(each.findings) for each in rows)
    return f"{counted(len(rows), 'valve')}, {counted(recordings, 'recording')}"


def stick_band(finding: RecordFinding) -> str:
    """Return S with its interval in OP units; empty where nothing was estimated."""
    return "" if finding.s is None else value_words(finding.s)


def probability_words(finding: RecordFinding) -> str:
    """Return the probability that the valve sticks; a dash where it is not known."""
    return "-" if finding.probability is None else f"{finding.probability:.2f}"


def why(row: ValveRow) -> str:
    """Return why the verdict is as it is; of a record with flaws what they are."""
    lead = row.lead
    if lead.verdict == "not_testable" or not lead.quality.flaws:
        return lead.reason
    return f"{lead.reason}; record: {quality_words(lead.quality)}"


def what_next(row: ValveRow) -> str:
    """Return what to do next; where nothing can be said, what to record."""
    instead = record_instead(row.lead.quality)
    return instead if row.lead.verdict == "not_testable" and instead is not None else row.lead.action


def _cells(number: int, row: ValveRow) -> tuple[str, ...]:
    lead = row.lead
    count = str(len(row.findings))
    answer = (row.words, probability_words(lead), stick_band(lead))
    return (str(number), row.name, count, *answer, why(row), what_next(row))


def _short(text: str, longest: int) -> str:
    """Return the begin of a text: the table is an overview, reasons and steps are above and in the report."""
    return text if len(text) <= longest else f"{text[: longest - 3].rstrip()}..."


def fleet_csv(rows: Sequence[ValveRow]) -> str:
    """Return the list as CSV, a row a valve, numbers with all their digits, empty where not known."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = [each.name for each in INDICES]
    numbers = ("rank", "valve", "recordings", "verdict", "probability", "confidence", "s", "s_low", "s_high")
    quality = ("ts_s", "samples", "samples_per_period", "compression", "gaps_percent", "manual_percent")
    writer.writerow((*numbers, "why", "next", *quality, "record_instead", *names, "files"))
    for number, row in enumerate(rows, 1):
        lead, good = row.lead, row.lead.quality
        s = lead.s
        ends = (None, None, None) if s is None else (s.value, s.low, s.high)
        own = (number, _cell(row.name), len(row.findings), row.words, lead.probability, lead.confidence)
        record = (good.ts, good.samples, good.samples_per_period, good.compression, good.gaps_percent)
        indices = (lead.indices.get(name) for name in names)
        files = " ".join(each.recording for each in row.findings)
        instead = record_instead(good)
        writer.writerow(
            (
                *own,
                *ends,
                why(row),
                what_next(row),
                *record,
                good.manual_percent,
                instead,
                *indices,
                _cell(files),
            )
        )
    return text.getvalue()


def _cell(text: str) -> str:
    """Return a text that a spreadsheet does not take for a formula."""
    return f"'{text}" if text[:1] in {"=", "+", "-", "@"} else text
