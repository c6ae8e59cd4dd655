"""What several recordings say together, as one self-contained HTML page."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from agent.plots.workbench.overlay import overlay_figure
from agent.plots.workbench.report import EVIDENCE, number, page, picture, table
from agent.report.comparison_text import is_printed, unit_behind
from agent.report.headline import capital

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure

    from agent.workbench.several.joint_step import JointStep
    from agent.workbench.several.together import Together


def together_html(found: Together) -> str:
    """Return the page: verdict, errors of each step, numbers, what was tried, each recording."""
    title = escape(f"{len(found.recordings)} recordings of one loop: what is missing in the model")
    return page(title, (f"<h1>{title}</h1>", *_parts(found)))


def _parts(found: Together) -> Iterator[str]:
    yield f'<p class="verdict">{escape(capital(found.verdict_words))}.</p>'
    for name, why in found.left_out.items():
        yield f"<p>{escape(name)} is left out: {escape(why)}.</p>"
    if found.not_validated is not None:
        yield f"<p>{escape(found.not_validated)}.</p>"
    yield "<h2>How far the error falls</h2>"
    rows = [row for step in found.steps for row in _errors(step, found.recordings)]
    yield table(("model", "recording", "RMSE, fitted", "held out"), rows)
    yield "<p>RMSE is in PV units. Held out: what belongs to the loop is fitted to the other recordings.</p>"
    last = found.steps[-1].fitted
    yield "<h2>What all recordings share</h2>"
    shared = [
        (
            each.name,
            number(each.value),
            f"{number(each.low)} to {number(each.high)}",
            unit_behind(each).lstrip(),
        )
        for each in last.shared()
    ]
    yield table(("parameter", "value", "90 % interval", "unit"), shared)
    yield "<h2>What each recording has for itself</h2>"
    own = last.own()
    printed = [name for name in own[0] if is_printed(name)]
    rows = [
        (recording, *(number(mine[name]) for name in printed))
        for recording, mine in zip(found.recordings, own, strict=True)
    ]
    yield table(("recording", *printed), rows)
    if found.candidates:
        yield "<h2>What would make them likelier</h2>"
        head = "tried", "twice a logarithm", "held-out squared error lower by, %", EVIDENCE
        tried = [
            (
                each.effect,
                f"{each.criterion:.1f}",
                f"{each.error_reduction_percent:.1f}",
                each.objection or "",
            )
            for each in found.candidates
        ]
        yield table(head, tried)
    for i, name in enumerate(found.recordings):
        yield picture(f"the models on {name}", _overlay(found, i))


def _errors(step: JointStep, recordings: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    model = "base" if step.added is None else f"+ {step.added}"
    for name, fitted, held_out in zip(recordings, step.rmse, step.rmse_held_out, strict=True):
        yield model, name, number(fitted), number(held_out)
    if step.rmse_validation is not None:
        yield model, "validation", "", number(step.rmse_validation)


def _overlay(found: Together, i: int) -> Figure:
    record = found.steps[0].fitted.joint.predictors[i].objective.record
    models = {
        "base" if step.added is None else f"+ {step.added}": step.fitted.fits[i].pv for step in found.steps
    }
    pv = np.where(record.weight > 0, record.pv, np.nan)
    return overlay_figure(found.recordings[i], record.facts.ts, pv, models)
