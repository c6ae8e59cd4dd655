"""The list of valves as one self-contained page: data first, then a row a valve, with small pictures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from agent.analysis.indices import INDICES
from agent.durations import duration_words
from agent.report.fleet.quality_words import quality_words, record_instead
from agent.report.fleet.table import probability_words, size_words, stick_band, what_next, why
from agent.report.ranking import GROUPS

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from agent.analysis.record.recording import FloatArray
    from agent.report.fleet.rows import RecordFinding, ValveRow
    from agent.report.fleet.thumbnail import Thumbnail
    from agent.report.ranking import Group

WIDTH, HEIGHT, GAP = 220, 64, 6
"""Of a small picture, px; OP below PV."""
BAR = 120
"""Width of the bar of S, px."""
SHAPES: Mapping[Group, str] = {
    "sticks": '<path d="M7 1 13 13H1Z" fill="#b42318"/>',
    "suspected": '<path d="M7 1 13 13H1Z" fill="none" stroke="#b42318" stroke-width="1.6"/>',
    "tight_tuning": '<rect x="2" y="2" width="10" height="10" fill="#8a6100"/>',
    "disturbance": '<path d="M7 1 13 7 7 13 1 7Z" fill="#5b6b7b"/>',
    "undecided": '<circle cx="7" cy="7" r="5" fill="none" stroke="#5b6b7b" stroke-width="1.6"/>',
    "not_testable": '<path d="M2 2 12 12M12 2 2 12" stroke="#5b6b7b" stroke-width="2"/>',
    "healthy": '<circle cx="7" cy="7" r="4" fill="#b8c1ca"/>',
    "waiting": '<path d="M2 7H12" stroke="#b8c1ca" stroke-width="2"/>',
}
"""A shape for each verdict: colour alone is lost in print."""
STYLE = """
body { font: 14px/1.45 system-ui, sans-serif; color: #22303f; margin: 2em auto; max-width: 1240px;
  padding: 0 1em; }
h1 { font-size: 1.5em; margin-bottom: 0.2em; }
table { border-collapse: collapse; width: 100%; margin: 1em 0; }
th, td { padding: 0.45em 0.9em 0.45em 0; text-align: left; vertical-align: top; }
td { border-bottom: 1px solid #e4e8ec; }
th { border-bottom: 1px solid #b8c1ca; font-weight: 600; }
.data td { white-space: nowrap; } .data td:nth-last-child(-n+2) { white-space: normal; }
td.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
.verdict { white-space: nowrap; } .verdict svg { vertical-align: -2px; margin-right: 0.4em; }
.muted { color: #5a6775; } .flaw { color: #b42318; }
tr { break-inside: avoid; } thead { display: table-header-group; }
@media print { body { margin: 0; max-width: none; font-size: 11px; } h2 { break-before: page; } }
"""


def fleet_html(rows: Sequence[ValveRow], title: str, not_read: Sequence[str] = ()) -> str:
    """Return the page.

    Args:
        rows: The most urgent first.
        title: For a reader, not escaped.
        not_read: What could not be read or was left out, a line each.
    """
    head = f'<meta charset="utf-8"><title>{escape(title)}</title><style>{STYLE}</style>'
    body = "\n".join(
        (
            f"<h1>{escape(title)}</h1>",
            *_summary(rows),
            *_valves(rows),
            *_data(rows),
            *_indices(rows),
            *_not_read(not_read),
        )
    )
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def _summary(rows: Sequence[ValveRow]) -> Iterator[str]:
    counts = Counter(row.group for row in rows)
    words = ", ".join(f"{name.lower()} {counts[group]}" for group, name in GROUPS.items() if counts[group])
    yield f'<p class="muted">{size_words(rows)}: {escape(words)}.</p>'
    flawed = [row for row in rows if row.lead.quality.flaws]
    if flawed:
        names = ", ".join(f"{row.name} ({quality_words(row.lead.quality)})" for row in flawed)
        yield f'<p class="flaw">Records that spoil a verdict: {escape(names)}.</p>'
    else:
        yield '<p class="muted">Data: no record has a flaw that spoils a verdict.</p>'


def _valves(rows: Sequence[ValveRow]) -> Iterator[str]:
    largest = max((_high(row.lead) for row in rows), default=0.0) or 1.0
    heads = ("", "valve", "verdict", "probability", "S, OP units, 90 %", "PV and OP", "why", "next")
    yield _open(heads)
    for number, row in enumerate(rows, 1):
        lead = row.lead
        count = len(row.findings)
        shape = f'<svg width="14" height="14" aria-hidden="true">{SHAPES[row.group]}</svg>'
        records = "" if count == 1 else f'<br><span class="muted">{count} recordings</span>'
        cells = (
            f'<td class="number">{number}</td>',
            f"<td>{escape(row.name)}{records}</td>",
            f'<td class="verdict">{shape}{escape(row.words)}</td>',
            f'<td class="number">{probability_words(lead)}</td>',
            f"<td>{stick_band(lead)}{_bar(lead, largest)}</td>",
            f"<td>{'' if lead.thumbnail is None else _picture(lead.thumbnail)}</td>",
            f"<td>{escape(why(row))}</td>",
            f"<td>{escape(what_next(row))}</td>",
        )
        yield f"<tr>{''.join(cells)}</tr>"
    yield "</tbody></table>"


def _data(rows: Sequence[ValveRow]) -> Iterator[str]:
    yield "<h2>Data</h2>"
    heads = (
        "recording",
        "every",
        "for",
        "samples a period",
        "compression",
        "gaps",
        "not automatic",
        "quality",
    )
    yield _open((*heads, "record instead"), "data")
    for finding in (each for row in rows for each in row.findings):
        good = finding.quality
        cells = (
            escape(finding.recording),
            f"{good.ts:g} s",
            duration_words(good.duration),
            _number(good.samples_per_period, ".1f"),
            _number(good.compression, ".1f"),
            f"{good.gaps_percent:.1f} %",
            "" if good.manual_percent is None else f"{good.manual_percent:.1f} %",
            escape(quality_words(good)),
            escape(record_instead(good) or ""),
        )
        yield "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
    yield "</tbody></table>"


def _indices(rows: Sequence[ValveRow]) -> Iterator[str]:
    yield "<h2>Performance indices</h2>"
    yield _open(("valve", *(_index_name(each.name, each.unit) for each in INDICES)))
    for row in rows:
        cells = "".join(
            f'<td class="number">{_number(row.lead.indices.get(each.name), ".4g")}</td>' for each in INDICES
        )
        yield f"<tr><td>{escape(row.name)}</td>{cells}</tr>"
    yield "</tbody></table>"


def _index_name(name: str, unit: str) -> str:
    words = name.replace("_", " ")
    return f"{words}, {unit}" if unit else words


def _not_read(lines: Sequence[str]) -> Iterator[str]:
    if lines:
        yield "<h2>Not read</h2><ul>"
        yield from (f"<li>{escape(line)}</li>" for line in lines)
        yield "</ul>"


def _open(heads: Iterable[str], kind: str = "") -> str:
    cells = "".join(f"<th>{escape(each)}</th>" for each in heads)
    return f'<table class="{kind}"><thead><tr>{cells}</tr></thead><tbody>'


def _number(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _high(finding: RecordFinding) -> float:
    s = finding.s
    return 0.0 if s is None else s.value if s.high is None else s.high


def _bar(finding: RecordFinding, largest: float) -> str:
    """Return S as a bar with its interval, all on one scale."""
    s = finding.s
    if s is None:
        return ""
    value = BAR * s.value / largest
    low, high = (value if end is None else BAR * min(end, largest) / largest for end in (s.low, s.high))
    ends = f"M{low + 1:.1f} 6H{high + 1:.1f}M{low + 1:.1f} 2V10M{high + 1:.1f} 2V10"
    words = f"S {stick_band(finding)} OP units"
    whole = f'<rect x="1" y="4" width="{value:.1f}" height="4" fill="#b8c1ca"/>'
    drawn = f'{whole}<path d="{ends}" stroke="#22303f"/>'
    return f'<br><svg width="{BAR + 4}" height="12" role="img" aria-label="{words}">{drawn}</svg>'


def _picture(small: Thumbnail) -> str:
    when = f"{duration_words(small.start)} to {duration_words(small.end)} from the start"
    half = (HEIGHT - GAP) / 2
    lines = (
        f'<path d="{_path(small.pv, 0.0, half)}" fill="none" stroke="#30435b"/>'
        f'<path d="{_path(small.op, half + GAP, half)}" fill="none" stroke="#1f8a70"/>'
    )
    words = f"PV above, OP below, {when}"
    drawn = f'<svg width="{WIDTH}" height="{HEIGHT}" role="img" aria-label="{words}">{lines}</svg>'
    return f'{drawn}<br><span class="muted">{when}</span>'


def _path(values: FloatArray, top: float, height: float) -> str:
    """Return the line through ``values`` (k,) in a box; gaps stay open."""
    if not np.isfinite(values).any():
        return ""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    scale = (height - 2) / (high - low) if high > low else 0.0
    words, pen = [], "M"
    for at, value in enumerate(values.tolist()):
        if np.isnan(value):
            pen = "M"
            continue
        x, y = WIDTH * at / max(1, len(values) - 1), top + height - 1 - scale * (value - low)
        words.append(f"{pen}{x:.1f} {y:.1f}")
        pen = "L"
    return "".join(words)
