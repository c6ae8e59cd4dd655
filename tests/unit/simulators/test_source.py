import math
from pathlib import Path

import numpy as np

from connectors.recording import RecordedLoop, read_recording
from simulators.parameters import ControllerParameters, ProcessParameters
from simulators.plant import simulate
from simulators.scenario import Scenario
from simulators.source import PlantSource, RecordingSource, Source


def recording(time, **other):
    n = len(time)
    columns = {"op": np.arange(n) + 50.0, "pv": np.arange(n) + 7.0, "sp": None, "mv": None, "mode": None}
    return RecordedLoop(
        name="FIC9", path=Path("FIC9.csv"), time=np.array(time), duplicates=0, **(columns | other)
    )


def test_plant_starts_anew_with_each_call():
    scenario = Scenario(
        loop="TIC1",
        duration=20.0,
        ts=2.0,
        controller=ControllerParameters(kc=1, ti=10, sp=5),
        process=ProcessParameters(gain=1, tau=5),
    )
    source: Source = PlantSource(scenario)
    assert (source.loop, source.ts) == ("TIC1", 2.0)
    rows = list(source.rows())
    assert rows == list(source.rows())
    assert [row.values["pv"] for row in rows] == simulate(scenario).pv.tolist()


def test_recording_gives_only_what_it_has_and_keeps_its_gaps():
    source: Source = RecordingSource(recording([10.0, 15.0, 20.0], pv=np.array([1.0, math.nan, 3.0])))
    assert (source.loop, source.ts) == ("FIC9", 5.0)
    *rows, ended = source.rows()
    assert [row.time for row in rows] == [10.0, 15.0, 20.0]
    assert all(set(row.values) == {"op", "pv"} for row in rows)
    assert [row.values["op"] for row in rows] == [50.0, 51.0, 52.0]
    assert math.isnan(rows[1].values["pv"])
    assert ended.time == 25.0
    assert all(math.isnan(value) for value in ended.values.values())


def test_recording_with_every_role():
    full = recording([0.0, 1.0], sp=np.array([9.0, 9.0]), mv=np.array([3.0, 4.0]), mode=("AUTO", "MAN"))
    rows = list(RecordingSource(full).rows())
    assert rows[1].values == {"pv": 8.0, "op": 51.0, "sp": 9.0, "mv": 4.0, "mode": "MAN"}
    assert rows[2].values["mode"] == "MAN"


def test_sampling_time_is_the_median_distance():
    assert RecordingSource(recording([0.0, 1.0, 2.0, 60.0, 61.0])).ts == 1.0
    assert RecordingSource(recording([5.0])).ts == 1.0


def test_real_recording(recordings):
    loop = read_recording(recordings / "isdb" / "CHEM10.csv")
    source = RecordingSource(loop)
    rows = list(source.rows())
    assert source.ts == 1.0
    assert len(rows) == len(loop.time) + 1
    assert rows[-2].values["op"] == loop.op[-1]
