"""All loops of one command as one plant: what oscillates together, printed and drawn."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from agent.cli.common.errors import complain

if TYPE_CHECKING:
    from agent.analysis.diagnosis import Diagnosis
    from agent.analysis.plant.plant import PlantFinding
    from agent.analysis.record.recording import LoopWindow
    from agent.cli.diagnosing.answer import Answer

PICTURE = "plant.png"


class PlantLoops:
    """The loops of a command, the last recording of each."""

    def __init__(self, folder: Path | None) -> None:
        """Begin empty; ``folder`` takes the picture, None: there is none."""
        self._folder = folder
        self._loops: dict[str, tuple[LoopWindow, Diagnosis]] = {}

    def add(self, answer: Answer) -> None:
        """Add the answer of a recording that could be read."""
        if answer.window is not None and answer.diagnosis is not None:
            name = answer.task.loop or answer.task.path.stem
            window = replace(answer.window, loop=name)
            self._loops[name] = window, replace(answer.diagnosis, loop=name)

    def say(self, *, as_json: bool) -> bool:
        """Print what they say together, and draw it; return whether that went well."""
        from agent.analysis.plant.plant import plant_finding
        from agent.report.fleet.plant_words import plant_json, plant_lines

        windows = [window for window, _ in self._loops.values()]
        finding = plant_finding(windows, [diagnosis for _, diagnosis in self._loops.values()])
        text = (
            json.dumps({"plant": plant_json(finding)}, allow_nan=False)
            if as_json
            else "\n".join(["", *plant_lines(finding)])
        )
        print(text, flush=True)  # noqa: T201 - this is the command's output
        return self._folder is None or not finding.groups or self._draw(self._folder, finding, windows)

    def _draw(self, folder: Path, finding: PlantFinding, windows: list[LoopWindow]) -> bool:
        from agent.plots.plant import plant_figure

        path = folder / PICTURE
        try:
            plant_figure(finding, windows).savefig(path, dpi=120)
        except OSError as error:
            complain(f"{path}: cannot be written: {error.strerror}")
            return False
        return True
