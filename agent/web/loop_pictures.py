"""Numbers and pictures of one diagnosis, made in a worker on demand; pure."""

from __future__ import annotations

import html
import io
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from agent.analysis.quantify.valves.error_map import ALIKE, error_map
from agent.report.diagnosis_text import diagnosis_lines
from agent.web.rows import numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import MethodResult, Profile

MAP_STEP = 0.02
"""Step of the map, share of the span of OP: the coarser end of what the paper takes."""
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


def profile_json(profile: Profile | None) -> dict[str, Any] | None:
    """Return the error against S with the delay and J that go with it."""
    if profile is None:
        return None
    return {
        "s": numbers(profile.s),
        "error": numbers(profile.error),
        "delay": numbers(profile.delay),
        "j": numbers(profile.j),
        "limit": float(profile.limit),
    }


def map_json(window: LoopWindow) -> dict[str, Any] | None:
    """Return the map of a window as rows of errors; None where nothing can be fitted to it."""
    errors = error_map(window, MAP_STEP)
    if errors is None:
        return None
    kind, best = errors.best
    return {
        "f_s": numbers(errors.f_s),
        "f_d": numbers(errors.f_d),
        "kind": kind,
        "best": {"f_s": best.f_s, "f_d": best.f_d},
        "alike": ALIKE,
        "error": [numbers(row, 4) for row in errors.error[errors.kinds.index(kind)]],
    }


def method_picture(loop: str, name: str, result: MethodResult) -> str | None:
    """Return what a detector saw as SVG; None where it left nothing to draw."""
    from agent.plots.detectors import detectors_figure  # noqa: PLC0415 - only workers pay for matplotlib

    figure = detectors_figure(loop, {name: result})
    if figure is None:
        return None
    figure.suptitle("")
    return svg(figure)


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


def svg(figure: Figure) -> str:
    """Return a figure as an SVG element."""
    text = io.StringIO()
    figure.savefig(text, format="svg")
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
