"""Files that unpack without end are refused in one line before they take the memory of the machine."""

import gzip
import subprocess
import sys

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
    monkeypatch.setattr(delimited, "MOST_TEXT_CELLS", 1000)
    path = tmp_path / "FIC101.csv.gz"
    path.write_bytes(gzip.compress(b"time,OP,PV\n" + b"0,0,0\n" * 10_000))
    with pytest.raises(RecordingError, match=r"line 251: has more than 1000 cells: split it"):
        read_export(path)


@pytest.mark.parametrize("packed", [False, True])
def test_bytes_are_bounded_however_long_the_file_goes_on(tmp_path, monkeypatch, packed):
    monkeypatch.setattr(unpacked, "MOST_BYTES", 1 << 20)
    path = tmp_path / ("FIC101.csv.gz" if packed else "FIC101.csv")
    content = b"time,OP,PV\n" + b"0,0,0\n" * (1 << 18)
    path.write_bytes(gzip.compress(content) if packed else content)
    with pytest.raises(RecordingError, match=r"FIC101.*is larger than 1 MiB unpacked: split it"):
        read_export(path)
