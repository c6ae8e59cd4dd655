"""``slipjump survey`` as a user runs it: killed at any moment, on a terminal or in a log, on a cluster."""

import json
import os
import random
import signal
import sqlite3
import subprocess
import sys
import time

import numpy as np
import pyarrow.parquet as pq
import pytest

from agent.cli import main
from agent.report.flat import flat
from agent.runtime.store.lock import only_user_of

DEADLINE = 120.0
LOOPS = 40


def write(path, seed, n=200):
    pv = np.round(np.random.default_rng(seed).normal(50, 1, n), 3)
    path.write_text("time,OP,PV\n" + "".join(f"{k},40,{value}\n" for k, value in enumerate(pv)))


@pytest.fixture
def archive(tmp_path):
    folder = tmp_path / "archive"
    folder.mkdir()
    for k in range(LOOPS):
        write(folder / f"L{k:03}.csv", k)
    return folder


def run(capsys, *words):
    with pytest.raises(SystemExit) as left:
        main([*map(str, words)])
    printed = capsys.readouterr()
    return left.value.code, printed.out, printed.err


def begun(archive, out):
    command = [sys.executable, "-c", "from agent.cli import main; main()", "survey", str(archive)]
    return subprocess.Popen(
        [*command, "-o", str(out), "--workers", "1"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


def done(out):
    try:
        with sqlite3.connect(f"{(out / 'survey.sqlite').as_uri()}?mode=ro", uri=True) as database:
            return database.execute("SELECT count(*) FROM loop").fetchone()[0]
    except sqlite3.Error:
        return 0


def killed_when(archive, out, condition):
    process = begun(archive, out)
    end = time.monotonic() + DEADLINE
    while process.poll() is None and not condition():
        assert time.monotonic() < end
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    process.wait()


def held(out):
    return pq.read_table(out / "survey.parquet").to_pylist()


def test_a_survey_that_was_killed_loses_no_loop_and_has_none_twice(archive, tmp_path, capsys):
    out = tmp_path / "out"
    killed_when(archive, out, lambda: done(out) >= 5)
    before = done(out)
    assert 5 <= before <= LOOPS
    assert not (out / "survey.parquet").exists() or before == LOOPS
    code, said, _ = run(capsys, "survey", archive, "-o", out)
    assert code == 0
    assert f"{LOOPS} recordings of {LOOPS} valves, " in said
    assert [row["recording"] for row in held(out)] == [f"L{k:03}.csv" for k in range(LOOPS)]


@pytest.mark.bench
def test_a_survey_that_was_killed_twenty_times_at_random(archive, tmp_path, capsys):
    out, random_times = tmp_path / "out", random.Random(1)
    for _ in range(20):
        wanted = time.monotonic() + random_times.uniform(0.1, 6)
        killed_when(archive, out, lambda wanted=wanted: time.monotonic() > wanted)
    assert run(capsys, "survey", archive, "-o", out)[0] == 0
    assert [row["loop"] for row in held(out)] == [f"L{k:03}" for k in range(LOOPS)]


def test_the_table_is_that_of_diagnose_and_what_cannot_be_read_is_named(tmp_path, capsys):
    for k in range(2):
        write(tmp_path / f"{k}.csv", k)
    (tmp_path / "bad.csv").write_text("time,OP,PV\n1,open,2\n")
    _, lines, _ = run(capsys, "diagnose", tmp_path / "0.csv", tmp_path / "1.csv", "--json")
    code, said, faults = run(capsys, "survey", tmp_path, "-o", tmp_path / "out", "--workers", 1)
    assert code == 2
    assert "bad.csv, line 2: OP is 'open', expected a number" in faults
    assert "not read: 1" in said
    for row, line in zip(held(tmp_path / "out"), lines.splitlines(), strict=True):
        expected = flat(json.loads(line))
        assert {key: row[key] for key in expected if key != "seconds"} == {
            key: value for key, value in expected.items() if key != "seconds"
        }
    page = (tmp_path / "out" / "survey.html").read_text()
    assert "Not read" in page
    assert "http" not in page.replace("http-equiv", ""), "self-contained"


def test_bad_usage_is_one_line(archive, tmp_path, capsys):
    code, _, said = run(capsys, "survey", tmp_path / "*.csv", "-o", tmp_path / "out")
    assert (code, said.count("\n")) == (2, 1)
    assert "no recording is there" in said
    words = ("survey", archive, "-o", tmp_path / "out", "--cluster", "tcp://127.0.0.1:9", "--workers", 2)
    assert "a cluster has its own workers" in run(capsys, *words)[2]
    (tmp_path / "file").write_text("")
    code, _, said = run(capsys, "survey", archive, "-o", tmp_path / "file")
    assert (code, said.count("\n")) == (2, 1)


def test_two_surveys_of_one_folder_do_not_mix(archive, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    with only_user_of(tmp_path / "out" / "survey.sqlite", "survey"):
        code, _, said = run(capsys, "survey", archive, "-o", tmp_path / "out")
    assert code == 2
    assert f"is used by another survey, process {os.getpid()}" in said
