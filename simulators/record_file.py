"""Simulated records as files: a recording any tool reads, and the truth beside it."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import yaml

from agent.units import FrictionBands

if TYPE_CHECKING:
    from pathlib import Path

    from simulators.plant import Row
    from simulators.scenario import Scenario

ROLES = {"OP": "op", "PV": "pv", "SP": "sp", "MV": "mv"}
"""Column by column the role of a row it holds."""


def write_rows(path: Path, rows: Iterable[Row]) -> None:
    """Write rows as CSV with columns time (ISO 8601, UTC), OP, PV, SP and MV; raises OSError."""
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file)
        table.writerow(["time", *ROLES])
        for row in rows:
            time = datetime.fromtimestamp(row.time, UTC).isoformat(timespec="milliseconds")
            table.writerow([time, *(f"{row.values[role]:.8g}" for role in ROLES.values())])


def write_truth(path: Path, scenario: Scenario) -> None:
    """Write what a diagnosis of the record should say as YAML; raises OSError."""
    truth = scenario.truth
    bands = FrictionBands(truth.f_s, truth.f_d)
    document = {"loop": scenario.loop, **truth.model_dump(), "s": bands.s, "j": bands.j}
    path.write_text(yaml.safe_dump(document, sort_keys=False), encoding="utf-8")
