"""Raw samples come back as a recording: from the agent's file and from the database, the same."""

import contextlib
import csv
import json
import math
from datetime import UTC, datetime

import numpy as np
import psycopg
import pytest
import yaml

from agent.cli import main
from agent.runtime.samples.minute import MINUTE, Minute, OpenMinute
from agent.runtime.samples.postgres_samples import PostgresSamples, samples_forwarder
from agent.runtime.samples.recalled import roles_of, rows_of
from agent.runtime.samples.sample_file import SampleFile, SampleGap, samples_path
from agent.settings import HistoryDatabase
from connectors.base import LoopRole, Quality, Sample
from tests.outages import all_sent
from tests.unit.runtime.agents import swinging

START = 1_700_000_040
"""s UTC, the start of a minute."""
ALWAYS = -math.inf, math.inf


class Held:
    """Minutes and gaps in memory."""

    def __init__(self, minutes, gaps=()):
        self._minutes, self._gaps = minutes, tuple(gaps)

    def minutes(self, _loop, since, before):
        return iter([each for each in self._minutes if since <= each.start < before])

    def gaps(self, since, before):
        return tuple(each for each in self._gaps if each.until >= since and each.since < before)


def minute(number, *came):
    """A minute of (role, second, value, quality) as they come."""
    made = OpenMinute("FIC101", START // MINUTE + number)
    for role, second, value, *quality in came:
        time = START + MINUTE * number + second
        made.put(Sample(LoopRole("FIC101", role), time, value, *quality or [Quality.GOOD]), 0.0)
    return made.table()


def recalled(minutes, gaps=(), span=ALWAYS):
    return [(row.time - START, row.values, row.mode) for row in rows_of(Held(minutes, gaps), "FIC101", *span)]


def test_a_role_is_held_until_it_is_reported_again_and_bad_is_a_gap():
    found = recalled(
        [
            minute(0, ("pv", 1, 5.0), ("op", 1.5, 40.0), ("mode", 2, "AUTO")),
            minute(1, ("pv", 0.25, 1.0, Quality.BAD), ("op", 3, 41.0), ("mode", 3, "MAN")),
        ]
    )
    assert [(time, mode) for time, _, mode in found] == [
        (1, ""),
        (1.5, ""),
        (2, "AUTO"),
        (60.25, "AUTO"),
        (63, "MAN"),
    ]
    values = [each for _, each, _ in found]
    assert values[:3] == [{"pv": 5.0}, {"pv": 5.0, "op": 40.0}, {"pv": 5.0, "op": 40.0}]
    assert math.isnan(values[3]["pv"])
    assert values[3]["op"] == 40.0
    assert math.isnan(values[4]["pv"])
    assert values[4]["op"] == 41.0


def test_behind_a_gap_nothing_is_held():
    minutes = [minute(0, ("pv", 1, 5.0), ("op", 1, 40.0)), minute(4, ("op", 1, 41.0))]
    gap = SampleGap(START + 60.0, START + 120.0, 2)
    assert [each for _, each, _ in recalled(minutes)] == [
        {"pv": 5.0, "op": 40.0},
        {"pv": 5.0, "op": 41.0},
    ]
    assert [each for _, each, _ in recalled(minutes, [gap])] == [{"pv": 5.0, "op": 40.0}, {"op": 41.0}]
    before = SampleGap(START - 600.0, START - 60.0, 2)
    assert len(recalled(minutes, [before])[1][1]) == 2


def test_rows_of_one_minute_that_came_apart_are_one_and_the_later_counts():
    late = minute(0, ("pv", 2, 9.0), ("op", 1, 44.0))
    found = recalled([minute(0, ("pv", 1, 5.0), ("op", 1, 40.0), ("pv", 3, 6.0)), late])
    assert found == [
        (1, {"pv": 5.0, "op": 44.0}, ""),
        (2, {"pv": 9.0, "op": 44.0}, ""),
        (3, {"pv": 6.0, "op": 44.0}, ""),
    ]


def test_a_span_begins_within_a_minute_with_what_held_then():
    minutes = [minute(0, ("pv", 1, 5.0), ("op", 10, 40.0), ("op", 20, 41.0), ("op", 30, 42.0))]
    assert recalled(minutes, span=(START + 20, START + 30)) == [(20, {"pv": 5.0, "op": 41.0}, "")]
    assert roles_of(Held(minutes), "FIC101", START + 20, START + 30) == ("op", "pv")


def an_hour(loop="FIC101"):
    """Sixty minutes of a loop that oscillates, one sample in ten of PV bad, OP every second time only."""
    made = []
    for number in range(60):
        held = OpenMinute(loop, START // MINUTE + number)
        for second in range(MINUTE):
            t = number * MINUTE + second
            pv, op = (each.value for each in swinging(loop, t))
            quality = Quality.BAD if t % 10 == 3 else Quality.GOOD
            held.put(Sample(LoopRole(loop, "pv"), START + t, pv, quality), 0.0)
            if t % 2 == 0:
                held.put(Sample(LoopRole(loop, "op"), START + t, op), 0.0)
        made.append(held)
    return made


@pytest.fixture
def plant(tmp_path, postgres):
    """The configuration of an agent whose file holds an hour of two loops, nothing of it sent."""
    with psycopg.connect(postgres.url, autocommit=True) as connection:
        connection.execute("DROP TABLE IF EXISTS slipjump_sample, slipjump_gap, slipjump_origin")
    state = tmp_path / "plant.sqlite"
    database = {"url": postgres.url, "tls": False, "samples": {}}
    config = {
        "agent": {"state": str(state), "history": {"database": database}},
        "connections": {"broker": {"kind": "mqtt", "host": "127.0.0.1"}},
        "loops": [
            {
                "name": "FIC101",
                "connection": "broker",
                "ts": 1.0,
                "tags": {role: {"topic": f"plant/{role}"} for role in ("pv", "op")},
            }
        ],
    }
    (tmp_path / "plant.yaml").write_text(yaml.safe_dump(config))
    with contextlib.closing(SampleFile(samples_path(state))) as file:
        file.write([*an_hour(), *an_hour("FIC102")], None)
    return tmp_path


def history(*words):
    with pytest.raises(SystemExit) as left:
        main(["history", *map(str, words)])
    return left.value.code


def send(folder, url):
    settings = HistoryDatabase.model_validate({"url": url, "tls": False})
    all_sent(samples_forwarder(samples_path(folder / "plant.sqlite"), settings))


def test_the_file_and_the_database_give_one_recording_that_is_diagnosed(plant, postgres, capsys):
    from_file, from_database = plant / "file" / "FIC101.csv", plant / "database" / "FIC101.csv"
    for each in (from_file, from_database):
        each.parent.mkdir()
    assert history("--state", plant / "plant.sqlite", "--samples", "FIC101", "--csv", from_file) == 0
    send(plant, postgres.url)
    assert history("--config", plant / "plant.yaml", "--samples", "FIC101", "--csv", from_database) == 0
    assert from_file.read_text() == from_database.read_text()
    with from_file.open() as text:
        rows = list(csv.DictReader(text))
    assert len(rows) == 3600
    assert list(rows[0]) == ["time", "OP", "PV"]
    assert rows[0]["time"] == datetime.fromtimestamp(START, UTC).isoformat()
    for t, row in enumerate(rows):
        pv, op = (each.value for each in swinging("FIC101", t - t % 2))
        assert float(row["OP"]) == pytest.approx(op, rel=1e-6)
        assert row["PV"] == "" if t % 10 == 3 else row["PV"] != ""
        if t % 2 == 0:
            assert float(row["PV"]) == pytest.approx(pv, rel=1e-6)
    capsys.readouterr()
    with pytest.raises(SystemExit) as left:
        main(["diagnose", "--json", str(from_database)])
    found = json.loads(capsys.readouterr().out)
    assert left.value.code == 0
    assert found["oscillation"]["period_s"] == pytest.approx(2 * math.pi * 8, rel=0.03)


def test_a_span_of_it_is_written(plant, postgres):
    send(plant, postgres.url)
    target = plant / "part.csv"
    since, until = (datetime.fromtimestamp(START + k, UTC).isoformat() for k in (90, 150))
    span = ["--since", since, "--until", until]
    words = ["--config", plant / "plant.yaml", "--samples", "FIC102", "--csv", target]
    assert history(*words, *span) == 0
    lines = target.read_text().splitlines()
    assert len(lines) == 61
    assert lines[1].startswith(since)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--samples", "FIC999", "--csv", "x.csv"], "no raw samples of FIC999 are kept of this time"),
        (["--samples", "FIC101"], "each only with the other"),
        (["--samples", "FIC101", "--window", "a@b", "--csv", "x.csv"], "each only with the other"),
        (["--until", "2026-11-22T06:00"], "only with --samples"),
        (["--samples", "FIC101", "--until", "noon", "--csv", "x.csv"], "'noon' is not a time"),
        (["--samples", "FIC101", "--csv", "no/x.csv"], "no/x.csv: No such file"),
    ],
)
def test_what_cannot_be_written_is_named(plant, capsys, monkeypatch, words, said):
    monkeypatch.chdir(plant)
    assert history("--state", "plant.sqlite", *words) == 2
    assert said in " ".join(capsys.readouterr().err.split())


def test_a_database_without_raw_samples_is_named(plant, capsys):
    words = ["--config", plant / "plant.yaml", "--samples", "FIC101", "--csv", plant / "x.csv"]
    assert history(*words) == 2
    assert "has no raw samples" in capsys.readouterr().err


def test_a_minute_from_the_database_is_as_it_was(plant, postgres):
    odd = OpenMinute("L", 7)
    odd.put(Sample(LoopRole("L", "pv"), 421.0, 1.5, Quality.GOOD), 0.0)
    odd.put(Sample(LoopRole("L", "op"), 422.0, 2.5, Quality.BAD), 0.0)
    odd.put(Sample(LoopRole("L", "mode"), 422.0, "MAN", Quality.GOOD), 0.0)
    with contextlib.closing(SampleFile(samples_path(plant / "plant.sqlite"))) as file:
        file.write([odd], SampleGap(60.0, 120.0, 3))
        assert file.gaps(0.0, 61.0) == (SampleGap(60.0, 120.0, 3),)
        assert file.gaps(121.0, 200.0) == file.gaps(0.0, 60.0) == ()
    send(plant, postgres.url)
    settings = HistoryDatabase.model_validate({"url": postgres.url, "tls": False})
    with contextlib.closing(PostgresSamples(settings, create=False)) as kept:
        (found,) = kept.minutes("L", 0.0, 600.0)
        assert kept.gaps(0.0, 61.0) == (SampleGap(60.0, 120.0, 3),)
    expected = Minute.unpacked("L", 420.0, odd.table().packed())
    assert (found.start, found.mode, list(found.at)) == (420.0, expected.mode, list(expected.at))
    assert found.quality.tolist() == expected.quality.tolist()
    assert found.columns.keys() == expected.columns.keys()
    for role, column in expected.columns.items():
        assert np.array_equal(found.columns[role].mask, column.mask)
        assert np.array_equal(found.columns[role].filled(-1), column.filled(-1), equal_nan=True)
