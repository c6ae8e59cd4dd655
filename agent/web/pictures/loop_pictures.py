"""Numbers and pictures of one diagnosis, made in a worker on demand; pure."""

from __future__ import annotations

import io
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from agent.analysis.quantify.valves.error_map import ALIKE, error_map
from agent.analysis.seen import look
from agent.web.rows import numbers

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agent.analysis.results import Profile
    from agent.analysis.seen import Seen
    from agent.runtime.loop.kept_fit import KeptFit

MAP_STEP = 0.02
"""Step of the map, share of the span of OP: the coarser end of what the paper takes."""


def profile_json(profile: Profile | None) -> dict[str, Any] | None:
    """Return how well each S agrees with the record, with the delay and J that go with it."""
    if profile is None:
        return None
    return {
        "s": numbers(profile.s),
        "p": numbers(profile.p),
        "delay": numbers(profile.delay),
        "j": numbers(profile.j),
        "limit": float(profile.limit),
    }


def map_json(kept: KeptFit) -> dict[str, Any] | None:
    """Return the map of a window as rows of errors; None where nothing can be fitted to it."""
    window, _ = kept.packed.open()
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


def method_picture(name: str, kept: KeptFit) -> str | None:
    """Return what a detector sees in the window as SVG; None where there is nothing to draw."""
    from agent.plots.detectors import detectors_figure  # noqa: PLC0415 - only workers pay for matplotlib

    found = _look(kept).methods
    figure = detectors_figure("", {name: found[name]}) if name in found else None
    if figure is None:
        return None
    figure.suptitle("")
    return svg(figure)


@lru_cache(maxsize=1)  # a page requests the pictures of one loop, one after the other
def _look(kept: KeptFit) -> Seen:
    """Look at the window once more: it shows what it showed when it was judged."""
    window, _ = kept.packed.open()
    return look(window)


def svg(figure: Figure) -> str:
    """Return a figure as an SVG element."""
    text = io.StringIO()
    figure.savefig(text, format="svg")
    drawn = text.getvalue()
    return drawn[drawn.index("<svg") :]
