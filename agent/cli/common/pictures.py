"""The pictures of ``slipjump diagnose --plot``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import chain, count
from pathlib import Path
from typing import TYPE_CHECKING

import typer

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.record.recording import LoopWindow

DPI = 110
SUFFIXES = ("-contour", "-profile", "-detectors")
"""Of the stems of the pictures beside NAME.png that not every recording has."""


def picture_files(recordings: Sequence[Path], folder: Path | None) -> list[Path | None]:
    """Return the file of each recording's fit; recordings of one name get a number.

    Raises:
        BadParameter: ``folder`` cannot be made.
    """
    if folder is None:
        return [None] * len(recordings)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        fault = f"{folder}: cannot be made a folder: {error.strerror}"
        raise typer.BadParameter(fault, param_hint="'--plot'") from error
    taken: set[str] = set()
    files: list[Path | None] = []
    for path in recordings:
        names = chain([path.stem], (f"{path.stem}_{number}" for number in count(2)))
        free = next(name for name in names if taken.isdisjoint(_stems(name)))
        taken.update(_stems(free))
        files.append(folder / f"{free}.png")
    return files


def _stems(name: str) -> set[str]:
    """Return the stems of all pictures of a recording, in small letters: some file systems see no others."""
    return {f"{name}{suffix}".lower() for suffix in ("", *SUFFIXES)}


def draw(window: LoopWindow, diagnosis: Diagnosis, file: Path) -> tuple[str, ...]:
    """Draw NAME.png and the pictures of ``SUFFIXES`` that there are; return what failed.

    Those that an earlier run left and this one does not draw are removed: they show another analysis.
    """
    faults = []
    figures = dict(figures_of(window, diagnosis))
    for suffix in ("", *SUFFIXES):
        path, figure = file.with_stem(f"{file.stem}{suffix}"), figures.get(suffix)
        try:
            if figure is None:
                path.unlink(missing_ok=True)
            else:
                figure.savefig(path, dpi=DPI)
        except OSError as error:
            fate = "removed" if figure is None else "written"
            faults.append(f"{path}: cannot be {fate}: {error.strerror}")
    return tuple(faults)


def figures_of(window: LoopWindow, diagnosis: Diagnosis) -> Iterator[tuple[str, Figure]]:
    """Yield each picture with the suffix of its file's stem."""
    from agent.analysis.quantify.valves.error_map import error_map
    from agent.plots.contour import contour_figure
    from agent.plots.detectors import detectors_figure
    from agent.plots.fit import fit_figure
    from agent.plots.profile import profile_figure

    yield "", fit_figure(window, diagnosis)
    found = diagnosis.quantification
    errors = None if found is None else error_map(window)
    if found is not None and errors is not None:
        yield "-contour", contour_figure(diagnosis.loop, errors, found)
    if found is not None and found.profile is not None:
        yield (
            "-profile",
            profile_figure(diagnosis.loop, found.profile, found.s),
        )
    detectors = detectors_figure(diagnosis.loop, diagnosis.methods)
    if detectors is not None:
        yield "-detectors", detectors
