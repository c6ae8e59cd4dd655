"""One diagnosis to be printed or sent: a report, a work order, a figure; made in a worker on demand; pure."""

from __future__ import annotations

import html
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from agent.report.advice import advice
from agent.report.diagnosis_text import diagnosis_lines, estimate_line
from agent.report.reasons import reasons
from agent.web.pictures.loop_pictures import svg

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow

REPORT = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{loop}: {verdict}</title>
<style>
body {{ font: 15px/1.5 system-ui, sans-serif; color: #1b2025; }}
body {{ max-width: 1000px; margin: 2rem auto; padding: 0 1rem; }}
h1 {{ margin-bottom: 0; }} .quiet {{ color: #535e68; }} svg {{ width: 100%; height: auto; }}
pre {{ font: inherit; white-space: pre-wrap; }} figure {{ margin: 1.5rem 0; }}
@media print {{ body {{ margin: 0; }} figure {{ break-inside: avoid; }} }}
</style></head><body>
<h1>{loop}: {verdict}</h1>
<p class="quiet">slipjump, made {made} UTC</p>
<pre>{text}</pre>
{figures}
</body></html>
"""
ORDER = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>Work order: {loop}</title><style>{style}</style></head><body>
<h1>Work order: control valve of {loop}</h1>
<p class="quiet">proposed by slipjump, {made} UTC</p>
{parts}
</body></html>
"""
LINES = (
    "Work order number",
    "Requested by, date",
    "Valve, positioner: make and serial number",
    "Found",
    "Done",
    "Done by, date",
)
"""That people fill in."""


def report(window: LoopWindow | None, diagnosis: Diagnosis, now: float) -> str:
    """Return the diagnosis with its pictures as one page that needs no other file."""
    from agent.plots.fit import fit_figure  # noqa: PLC0415
    from agent.plots.profile import profile_figure  # noqa: PLC0415

    found, figures = diagnosis.quantification, []
    if window is not None:
        figures.append(fit_figure(window, diagnosis))
    if found is not None and found.profile is not None:
        figures.append(profile_figure(diagnosis.loop, found.profile, found.s))
    return REPORT.format(
        loop=html.escape(diagnosis.loop),
        verdict=html.escape(diagnosis.verdict.replace("_", " ")),
        made=f"{datetime.fromtimestamp(now, UTC):%Y-%m-%d %H:%M}",
        text=html.escape("\n".join(line.strip() for line in list(diagnosis_lines(diagnosis))[1:])),
        figures="\n".join(f"<figure>{svg(figure)}</figure>" for figure in figures),
    )


def work_order(window: LoopWindow | None, diagnosis: Diagnosis, now: float) -> str:
    """Return a page for the workshop: finding, picture, S, proposed test, lines to fill in."""
    from agent.plots.fit import fit_figure  # noqa: PLC0415 - only workers pay for matplotlib

    found = diagnosis.quantification
    stiction = None if found is None else found.stiction
    s = None if stiction is None else estimate_line("S", stiction.s, identifiable=stiction.identifiable_s)
    parts = [
        _section(
            "Finding", [diagnosis.verdict.replace("_", " "), *([s] if s else []), *reasons(diagnosis)[:4]]
        ),
        _section("Proposed test and repair", list(advice(diagnosis)) or ["none"]),
        "<h2>To be filled in</h2>" + "".join(f"<p>{html.escape(each)}: {'_' * 50}</p>" for each in LINES),
    ]
    if window is not None:
        parts.append(f"<figure>{svg(fit_figure(window, diagnosis))}</figure>")
    return ORDER.format(
        loop=html.escape(diagnosis.loop),
        made=f"{datetime.fromtimestamp(now, UTC):%Y-%m-%d %H:%M}",
        style=REPORT.partition("<style>")[2].partition("</style>")[0].replace("{{", "{").replace("}}", "}"),
        parts="\n".join(parts),
    )


def figure_svg(window: LoopWindow, diagnosis: Diagnosis) -> str:
    """Return the picture of a window with its model."""
    from agent.plots.fit import fit_figure  # noqa: PLC0415

    return svg(fit_figure(window, diagnosis))


def _section(title: str, lines: list[str]) -> str:
    return f"<h2>{title}</h2><ul>" + "".join(f"<li>{html.escape(each)}</li>" for each in lines) + "</ul>"
