"""Numbers and pictures of one diagnosis, made in a worker on demand; pure."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from agent.analysis.quantify.valves.error_map import ALIKE, error_map
from agent.web.rows import numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agent.analysis.record.recording import LoopWindow
    from agent.analysis.results import MethodResult, Profile

MAP_STEP = 0.02
"""Step of the map, share of the span of OP: the coarser end of what the paper takes."""


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


def svg(figure: Figure) -> str:
    """Return a figure as an SVG element."""
    text = io.StringIO()
    figure.savefig(text, format="svg")
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
