"""A comparison as one self-contained HTML page: pictures are embedded, no external address."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping
from html import escape
from io import BytesIO
from typing import TYPE_CHECKING

from agent.report.comparison_text import (
    CANDIDATES,
    causes_words,
    evidence_words,
    in_words,
    step_name,
    verdict_words,
)
from agent.report.headline import capital, headline
from agent.report.numbers import p_words, share_words, tenths
from agent.workbench.residual.state_dependence import LEVEL

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from matplotlib.figure import Figure

    from agent.workbench.comparison import Comparison, StepEvidence
    from agent.workbench.step import Step, VerdictKind

DPI = 110
EVIDENCE = "evidence"
"""Head of the column whose cells are words."""
CAPTIONS = {
    "overlay": (
        "Every model is simulated from the measured OP alone, without measured PV. Its score is the error on "
        "the numbered blocks; the fit that predicts a block did not use it."
    ),
    "contributions": "PV of the model less PV of the same model without the effect.",
    "staircase": (
        "Each step refits all parameters. An effect counts only if it reduces the error on held-out blocks."
    ),
    "candidates": (
        "Each effect was added to the last model, which was refitted and scored on the held-out blocks. p is "
        "adjusted for the number of candidates."
    ),
    "next_test": (
        "What to do at the loop, and what either model would measure, with one deviation of the noise. "
        "Sizes and times are the least that distinguish them."
    ),
    "where_it_fails": (
        "The grey band contains the mean if residual and axis are unrelated. In closed loop OP responds to "
        "the residual, so a mean outside the band alone is no failure; p takes this into account."
    ),
    "spectrum": (
        "A line that is locked to the reversals of OP is made in the loop, a line with a constant frequency "
        "of its own comes from outside."
    ),
    "correlations": (
        "On the right a bar outside the band means that the model lacks a part of the response of PV to OP."
    ),
}
"""What each picture shows, under its name of ``comparison_figures``."""
KINDS: Mapping[VerdictKind, str] = {
    "confirmed": "the record confirms it",
    "family": "the record confirms its family",
    "suggested": "the record suggests it, no more",
    "none_of_the_known": "the record does not confirm it",
    "no_failure_visible": "the record does not confirm it",
    "not_testable": "the record cannot show it",
}
"""What led to a step, in words."""
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; color: #22303f; max-width: 1080px; margin: 2em auto; }
img { max-width: 100%; height: auto; }
figure { margin: 1.5em 0; }
figcaption { color: #5a6775; }
table { border-collapse: collapse; margin: 1em 0; }
th, td { padding: 0.2em 0.9em 0.2em 0; text-align: right; }
th { border-bottom: 1px solid #b8c1ca; font-weight: 600; }
td { white-space: nowrap; } td.words { white-space: normal; }
th:first-child, td:first-child, .words { text-align: left; }
.verdict { font-size: 1.15em; border-left: 4px solid #d9541e; padding-left: 0.8em; }
"""


def report_html(found: Comparison, figures: Mapping[str, Figure]) -> str:
    """Return the page: what was found first, each step with its evidence, and what could not have been seen.

    Args:
        found: What the session found.
        figures: Pictures by their names in ``comparison_figures``; others are shown without a caption.
    """
    title = escape(f"{found.loop}: what is missing in the model")
    parts = [f"<h1>{title}</h1>", f'<p class="verdict">{escape(capital(headline(found)))}.</p>']
    if found.steps:
        parts += _text(found)
    parts += [picture(name, figure) for name, figure in figures.items()]
    if found.unseen:
        parts.append("<h2>What could not have been seen</h2>")
        parts.append("<ul>" + "".join(f"<li>{escape(each)}</li>" for each in found.unseen) + "</ul>")
    return page(title, parts)


def page(title: str, parts: Iterable[str]) -> str:
    """Return a whole page; ``title`` and ``parts`` are HTML already."""
    head = f'<meta charset="utf-8"><title>{title}</title><style>{STYLE}</style>'
    body = "\n".join(parts)
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def _text(found: Comparison) -> Iterable[str]:
    yield f"<p>The last model: {escape(verdict_words(found.verdict, found))}.</p>"
    if found.next_test is not None:
        yield f"<p>The next test, {escape(found.next_test.words)}.</p>"
    yield "<h2>How far the error falls</h2>"
    validated = any(step.rmse_validation is not None for step in found.steps)
    steps = [
        (
            in_words(step_name(step)),
            number(step.rmse_fit),
            number(step.held_out.rmse),
            *((number(step.rmse_validation),) if validated else ()),
            f"{step.fit_percent:.1f}",
        )
        for step in found.steps
    ]
    other = ("other recording",) if validated else ()
    yield table(("model", "RMSE, fitted", "held out", *other, "fit %"), steps)
    if found.noise_floor is not None:
        low, high = number(found.noise_floor.low), number(found.noise_floor.high)
        floor = f"The noise floor is between {low} and {high}: no model can do better."
        yield f"<p>RMSE is in PV units. {floor}</p>"
    for place, (step, evidence) in enumerate(zip(found.steps, found.evidence, strict=True)):
        if place:
            yield f"<h2>Step {place}: {escape(in_words(step_name(step)))}</h2>"
            yield from _step(step, evidence)
    yield "<h2>Parameters of the last model</h2>"
    rows = [
        (each.name, number(each.value), f"{number(each.low)} to {number(each.high)}", each.unit)
        for each in found.steps[-1].numbers
    ]
    yield table(("parameter", "value", "90 % interval", "unit"), rows)


def _step(step: Step, evidence: StepEvidence) -> Iterable[str]:
    """Yield what led to a step."""
    if step.dropped is not None:
        yield f"<p>{escape(in_words(step.dropped))} was taken out and everything fitted again.</p>"
        return
    failing = [each for each in evidence.where_it_fails if each.p < LEVEL]
    if failing:
        worst = failing[0]
        axis, share = escape(in_words(worst.axis)), share_words(worst.share)
        causes = escape(causes_words(worst.axis))
        yield (
            f"<p>The model before failed with {axis}: {share} of the residual, {p_words(worst.p)}. "
            f"Such a pattern is made by: {causes}.</p>"
        )
    rows = [
        (
            in_words(each.effect),
            tenths(each.error_reduction_percent),
            f"{tenths(each.low)} to {tenths(each.high)}",
            evidence_words(each),
        )
        for each in evidence.candidates[:CANDIDATES]
    ]
    if rows:
        yield table(("tried", "held-out squared error lower by, %", "90 % interval", EVIDENCE), rows)
    if step.verdict is not None:
        others = " or ".join(map(in_words, step.verdict.indistinguishable))
        beside = f"; this record cannot distinguish it from {others}" if others else ""
        yield f"<p>{escape(in_words(str(step.added)))}: {KINDS[step.verdict.kind]}{escape(beside)}.</p>"


def number(value: float | None) -> str:
    """Return a number for a cell, empty where there is none."""
    return "" if value is None else f"{value:.4g}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table; cells are escaped."""
    lines = [
        "<tr>" + "".join(_cell(tag, cell, name) for cell, name in zip(row, head, strict=True)) + "</tr>"
        for tag, row in (("th", head), *(("td", row) for row in rows))
    ]
    return "<table>" + "\n".join(lines) + "</table>"


def _cell(tag: str, cell: str, column: str) -> str:
    kind = ' class="words"' if column == EVIDENCE else ""
    return f"<{tag}{kind}>{escape(cell)}</{tag}>"


def picture(name: str, figure: Figure) -> str:
    """Return a picture with its caption, embedded."""
    file = BytesIO()
    figure.savefig(file, format="png", dpi=DPI)
    data = b64encode(file.getvalue()).decode("ascii")
    caption = escape(CAPTIONS.get(name, ""))
    image = f'<img alt="{escape(name.replace("_", " "))}" src="data:image/png;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>"
