"""A comparison as one HTML page that needs nothing else: pictures within, no address outside."""

from __future__ import annotations

from base64 import b64encode
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING

from agent.report.comparison_text import step_name, verdict_words

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from matplotlib.figure import Figure

    from agent.workbench.comparison import Comparison

DPI = 110
CAPTIONS = {
    "overlay": (
        "Every model runs freely from the measured OP; it never sees PV. Its score is that on the "
        "numbered blocks, each predicted by a fit that did not see it."
    ),
    "contributions": "The model less the same model without the effect.",
    "staircase": (
        "Each step refits everything. An effect counts only if blocks that no fit saw are predicted better."
    ),
    "candidates": (
        "Each effect was added to the last model, which was refitted and scored on the held-out blocks. p is "
        "adjusted for all that were tried."
    ),
    "where_it_fails": (
        "The grey band is where the mean would lie if residual and axis were unrelated. In closed loop OP "
        "answers to the residual, so a mean outside the band alone is no failure; p allows for that."
    ),
    "spectrum": (
        "A line that keeps step with the reversals of OP is made in the loop, one that keeps its own time "
        "comes from outside."
    ),
    "correlations": (
        "On the right a bar outside the band means that PV follows OP in a way that the model lacks."
    ),
}
"""What each picture shows, under its name of ``comparison_figures``."""
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #22303f; max-width: 1080px; margin: 2em auto; }
img { width: 100%; height: auto; }
figure { margin: 1.5em 0; }
figcaption { color: #5a6775; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.2em 0.9em 0.2em 0; text-align: right; }
th { border-bottom: 1px solid #b8c1ca; font-weight: 600; }
th:first-child, td:first-child { text-align: left; }
.verdict { font-size: 1.15em; border-left: 4px solid #d9541e; padding-left: 0.8em; }
"""


def report_html(found: Comparison, figures: Mapping[str, Figure]) -> str:
    """Return the page.

    Args:
        found: What the session found.
        figures: Pictures by their names in ``comparison_figures``; others are shown without a caption.
    """
    title = escape(f"{found.loop}: what is missing in the model")
    parts = [f"<h1>{title}</h1>"]
    if found.steps:
        parts += _text(found)
    else:
        parts.append(f'<p class="verdict">Not testable: {escape(found.reason or "")}</p>')
    parts += [_picture(name, figure) for name, figure in figures.items()]
    head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    body = "\n".join(parts)
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def _text(found: Comparison) -> Iterable[str]:
    yield f'<p class="verdict">Verdict: {escape(verdict_words(found.verdict, found))}.</p>'
    yield "<h2>How far the error falls</h2>"
    steps = [
        (
            step_name(step),
            _number(step.rmse_fit),
            _number(step.held_out.rmse),
            _number(step.rmse_validation),
            f"{step.fit_percent:.1f}",
        )
        for step in found.steps
    ]
    yield _table(("model", "RMSE, fitted", "held out", "other recording", "fit %"), steps)
    if found.noise_floor is not None:
        low, high = _number(found.noise_floor.low), _number(found.noise_floor.high)
        yield f"<p>RMSE is in PV units. No model can reach less than between {low} and {high}.</p>"
    yield "<h2>Parameters of the last model</h2>"
    rows = [
        (each.name, _number(each.value), f"{_number(each.low)} to {_number(each.high)}", each.unit)
        for each in found.steps[-1].parameters
    ]
    yield _table(("parameter", "value", "90 % interval", "unit"), rows)


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [
        "<tr>" + "".join(f"<{tag}>{escape(cell)}</{tag}>" for cell in row) + "</tr>"
        for tag, row in (("th", head), *(("td", row) for row in rows))
    ]
    return "<table>" + "\n".join(lines) + "</table>"


def _picture(name: str, figure: Figure) -> str:
    file = BytesIO()
    figure.savefig(file, format="png", dpi=DPI)
    data = b64encode(file.getvalue()).decode("ascii")
    caption = escape(CAPTIONS.get(name, ""))
    image = f'<img alt="{escape(name.replace("_", " "))}" src="data:image/png;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"
