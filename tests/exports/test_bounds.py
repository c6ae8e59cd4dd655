"""Files that unpack without end are refused in one line before they take the memory of the machine."""

import gzip
import subprocess
import sys

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from connectors.exports.fault import LONGEST_CELL, RecordingError
from connectors.exports.reading import read_export
from connectors.exports.tables import delimited, unpacked
from tests.conftest import ROOT

LIMIT = 2 << 30
"""Bytes of address space of the process that reads."""
READ = """
import resource, sys
from pathlib import Path
resource.setrlimit(resource.RLIMIT_AS, (int(sys.argv[2]),) * 2)
from connectors.exports.fault import RecordingError
from connectors.exports.reading import read_export
try:
    read_export(Path(sys.argv[1]))
except RecordingError as error:
    print(error)
"""


def repeated(path, text, rows):
    """Write a Parquet file of little size: one text, repeated."""
    numbers = pa.array([0.0]).take(pa.array([0] * rows))
    words = pa.DictionaryArray.from_arrays(pa.array([0] * rows, pa.int32()), pa.array([text]))
    pq.write_table(pa.table({"time": numbers, "OP": numbers, "PV": numbers, "mode": words}), path)


def test_a_text_that_a_parquet_file_repeats_is_bounded(tmp_path):
    path = tmp_path / "FIC101.parquet"
    repeated(path, "x" * 100_000, 100_000)  # 10 GB of text
    assert path.stat().st_size < 2 << 20
    command = [sys.executable, "-c", READ, str(path), str(LIMIT)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=60, cwd=ROOT, check=False)
    assert run.stderr == ""
    assert run.stdout == f"{path}: mode has a cell of 100000 characters, at most {LONGEST_CELL} are read\n"


def test_words_of_a_parquet_file_are_read_and_a_missing_one_is_empty(tmp_path):
    path = tmp_path / "FIC101.parquet"
    time, mode = pa.array([0.0, 1.0, 2.0]), pa.array(["AUTO", None, " MAN "])
    pq.write_table(pa.table({"time": time, "OP": time, "PV": time, "mode": mode}), path)
    assert read_export(path).loops[0].mode == ("AUTO", "", "MAN")


def test_cells_of_text_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(delimited, "MOST_CELLS", 1000)
    path = tmp_path / "FIC101.csv.gz"
    path.write_bytes(gzip.compress(b"time,OP,PV\n" + b"0,0,0\n" * 10_000))
    with pytest.raises(RecordingError, match=r"line 334: has more than 10000000 rows or 1000 cells"):
        read_export(path)


@pytest.mark.parametrize("packed", [False, True])
def test_bytes_are_bounded_however_long_the_file_goes_on(tmp_path, monkeypatch, packed):
    monkeypatch.setattr(unpacked, "MOST_BYTES", 1 << 20)
    path = tmp_path / ("FIC101.csv.gz" if packed else "FIC101.csv")
    content = b"time,OP,PV\n" + b"0,0,0\n" * (1 << 18)
    path.write_bytes(gzip.compress(content) if packed else content)
    with pytest.raises(RecordingError, match=r"FIC101.*is larger than 1 MiB unpacked: split it"):
        read_export(path)


PEAK = """
import sys
from pathlib import Path
import pyarrow.parquet
from connectors.exports.reading import read_export
def peak():
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM"))
read_export(Path(sys.argv[1]))  # what is imported and compiled
before = peak()
loops = read_export(Path(sys.argv[2])).loops
print(len(loops), sum(len(loop.time) for loop in loops), peak() - before)
"""
FORTY = [f"FIC{k:03d}" for k in range(40)]
ROWS = {"wide.csv": 20_000, "long.csv": 6_000, "wide.parquet": 60_000, "long.parquet": 20_000}
"""Times in the file; in a long table each has a row for each of eighty tags."""
MOST_GROWTH = {"wide.csv": 60_000, "long.csv": 70_000, "wide.parquet": 130_000, "long.parquet": 250_000}
"""kB above a file of forty rows. With all cells in memory: 185,000, 333,000, 176,000 and 352,000."""


def export_of(path, rows):
    """Write OP and PV of forty loops, a column a tag or a row a value."""
    times = [f"2026-03-01 {k // 3600:02d}:{k // 60 % 60:02d}:{k % 60:02d}" for k in range(rows)]
    tags = [f"{loop}.{role}" for loop in FORTY for role in ("OP", "PV")]
    values = (np.arange(rows)[:, None] * 7 + np.arange(len(tags)) * 13) % 1000 / 10
    seconds = np.arange(rows, dtype=float)
    if path.name == "wide.csv":
        rows_of_values = zip(times, values.tolist(), strict=True)
        lines = [f"{time},{','.join(map(str, row))}" for time, row in rows_of_values]
        path.write_text("\n".join([",".join(["time", *tags]), *lines]) + "\n")
    elif path.name == "long.csv":
        lines = [
            f"{tag},{time},{value},Good"
            for time, row in zip(times, values.tolist(), strict=True)
            for tag, value in zip(tags, row, strict=True)
        ]
        path.write_text("\n".join(["tag,time,value,quality", *lines]) + "\n")
    elif path.name == "wide.parquet":
        columns = {tag: values[:, n].copy() for n, tag in enumerate(tags)}
        pq.write_table(pa.table({"time": seconds, **columns}), path)
    else:
        words = pa.DictionaryArray.from_arrays(np.tile(np.arange(len(tags)), rows), tags)
        long = {"tag": words, "time": np.repeat(seconds, len(tags)), "value": values.reshape(-1)}
        pq.write_table(pa.table(long), path)


@pytest.mark.parametrize("name", ROWS)
def test_many_loops_in_one_file_are_read_in_bounded_memory(tmp_path, name):
    small, large = tmp_path / "small" / name, tmp_path / name
    small.parent.mkdir()
    export_of(small, 40)
    export_of(large, ROWS[name])
    command = [sys.executable, "-c", PEAK, str(small), str(large)]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, cwd=ROOT, check=False)
    assert run.stderr == ""
    loops, samples, growth = map(int, run.stdout.split())
    assert (loops, samples) == (len(FORTY), len(FORTY) * ROWS[name])
    assert growth <= MOST_GROWTH[name]
