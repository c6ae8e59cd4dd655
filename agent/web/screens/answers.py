"""Answers that several screens give."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fastapi import HTTPException
from starlette.responses import JSONResponse, Response

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow
    from agent.runtime.loop.pipeline import LoopPipeline
    from agent.web.plant import Plant


def too_many_pages() -> Response:
    """Return the answer to a stream that is one too many."""
    return JSONResponse({"detail": "too many pages are open"}, 503, {"Retry-After": "10"})


def loop_of(plant: Plant, name: str) -> LoopPipeline:
    """Return what is done for a loop; raises HTTPException where there is none of this name."""
    pipeline = plant.agent.pipelines.get(name)
    if pipeline is None:
        raise HTTPException(404, f"no loop is called {name}")
    return pipeline


def opened(held: LoopPipeline) -> tuple[LoopWindow | None, Diagnosis | None]:
    """Return the window of the newest diagnosis, where it got a fit, and the diagnosis with its curves."""
    return (None, held.diagnosis) if held.fitted is None else held.fitted.packed.open()


def csv_of(held: LoopPipeline) -> str:
    """Return the samples that are held of a loop as a recording."""
    start, columns = held.window.recent()
    names = {"pv": "PV", "op": "OP", "sp": "SP", "mv": "MV"}
    roles = [role for role in names if role in columns]
    lines = [",".join(["time", *(names[role] for role in roles)])]
    for k, values in enumerate(zip(*(columns[role].tolist() for role in roles), strict=True)):
        cells = ["" if value != value else repr(value) for value in values]  # noqa: PLR0124 - NaN
        lines.append(",".join([f"{start + k * held.settings.ts:.3f}", *cells]))
    return "\n".join(lines) + "\n"
