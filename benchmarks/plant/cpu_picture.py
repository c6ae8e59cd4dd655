"""CPU against loops, of the agent and of bare clients: the numbers as CSV, and their picture.

``python -m benchmarks.plant.cpu_picture FILE.csv`` draws FILE.svg again.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from matplotlib.figure import Figure

COLOURS = {"mqtt": "tab:blue", "modbus": "tab:orange", "opcua": "tab:green"}
NAMES = {"mqtt": "MQTT", "modbus": "Modbus", "opcua": "OPC UA"}
SIZE = (7.0, 4.5)
"""Inches."""


@dataclass(frozen=True)
class Cost:
    """What the loops of a bus cost."""

    bus: str
    loops: int
    agent: float
    """Cores that the agent took."""
    bare: float
    """Cores that the bare client took."""


def kept(costs: Iterable[Cost], file: Path) -> None:
    """Write costs as CSV."""
    with file.open("w", newline="", encoding="utf-8") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(each.name for each in fields(Cost))
        writer.writerows((bus, loops, f"{a:.5f}", f"{b:.5f}") for bus, loops, a, b in map(astuple, costs))


def read(file: Path) -> list[Cost]:
    """Return the costs of a file of ``kept``."""
    with file.open(newline="", encoding="utf-8") as rows:
        return [
            Cost(row["bus"], int(row["loops"]), float(row["agent"]), float(row["bare"]))
            for row in csv.DictReader(rows)
        ]


def picture(costs: Sequence[Cost], file: Path) -> None:
    """Draw cores against loops, both on logarithmic axes: what is flat a loop is a straight line."""
    figure = Figure(SIZE, layout="constrained")
    axes = figure.subplots()
    for bus in dict.fromkeys(each.bus for each in costs):
        some = sorted((each for each in costs if each.bus == bus), key=lambda each: each.loops)
        loops = [each.loops for each in some]
        name, colour = NAMES[bus], COLOURS[bus]
        axes.plot(loops, [each.agent for each in some], "o-", color=colour, label=f"{name}, agent")
        axes.plot(loops, [each.bare for each in some], "s--", color=colour, label=f"{name}, bare client")
    axes.set(xscale="log", yscale="log", xlabel="loops (OP, PV and SP at 1 Hz)", ylabel="CPU, cores")
    axes.grid(which="both", alpha=0.3)
    axes.legend()
    figure.savefig(file)


if __name__ == "__main__":
    picture(read(Path(sys.argv[1])), Path(sys.argv[1]).with_suffix(".svg"))
