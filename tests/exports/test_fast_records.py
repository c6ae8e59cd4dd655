"""A plain recording has seconds: also one of a rig that is sampled far faster than a control loop."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from connectors.exports.cells.clock_numbers import UnclearTimeError, clock_of
from connectors.recording import read_recording

SAMPLES = np.arange(1500)


@pytest.mark.parametrize("rate", [50.0, 100.0, 200.0, 250.0, 500.0, 610.3515625, 1000.0, 51200.0])
def test_a_fast_rig_has_seconds(rate: float) -> None:
    assert clock_of(SAMPLES / rate, "").name == "seconds"


@pytest.mark.parametrize("digits", [4, 5, 6, 9])
@pytest.mark.parametrize(
    ("unit", "step"),
    [(3600.0, 1.0), (3600.0, 10.0), *((86400.0, step) for step in (1.0, 10.0, 30.0, 60.0, 300.0))],
)
def test_what_may_be_hours_or_days_is_refused(unit: float, step: float, digits: int) -> None:
    with pytest.raises(UnclearTimeError):
        clock_of(np.round(SAMPLES * step / unit, digits), "")


def test_a_rig_of_500_hz_is_read(tmp_path: Path) -> None:
    path = tmp_path / "arm.csv"
    rows = (f"{k / 500:.4f},{k % 7},{k % 5}" for k in range(1000))
    path.write_text("time,OP,PV\n" + "\n".join(rows) + "\n")
    times = read_recording(path).time
    assert np.median(np.diff(times)) == pytest.approx(0.002)
