"""Recordings as they come from the field: what is read, what is a gap, what is refused and how."""

import math
from datetime import UTC, datetime

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from connectors.base import ConfigError
from connectors.recording import STANDARD, Columns, RecordingError, read_recording


@pytest.fixture
def write(tmp_path):
    def _write(text, name="FIC101.csv", encoding="utf-8"):
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return _write


def fault(path, columns=STANDARD):
    with pytest.raises(RecordingError) as raised:
        read_recording(path, columns)
    message = str(raised.value)
    assert "\n" not in message
    assert str(path) in message
    assert isinstance(raised.value, ConfigError)
    return message


def test_plain_seconds(write):
    loop = read_recording(write("time,OP,PV\n0,50,1.5\n1,51,1.25\n"))
    assert loop.name == "FIC101"
    np.testing.assert_array_equal(loop.time, [0, 1])
    np.testing.assert_array_equal(loop.op, [50, 51])
    np.testing.assert_array_equal(loop.pv, [1.5, 1.25])
    assert (loop.sp, loop.mv, loop.mode, loop.duplicates) == (None, None, None, 0)


@pytest.mark.parametrize(
    "stamp", ["2026-01-02T03:04:05", "2026-01-02 03:04:05Z", "2026-01-02T04:04:05+01:00"]
)
def test_iso_time_is_utc_where_naive(write, stamp):
    loop = read_recording(write(f"time,OP,PV\n{stamp},1,2\n"))
    assert loop.time[0] == datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC).timestamp()


def test_optional_columns_and_other_names(write):
    path = write("t,co,meas,set,stem,auto\n0,1,2,3,4,AUTO\n1,1,2,3,4,\n")
    names = Columns(time="t", op="co", pv="meas", sp="set", mv="stem", mode="auto")
    loop = read_recording(path, names)
    np.testing.assert_array_equal(loop.sp, [3, 3])
    np.testing.assert_array_equal(loop.mv, [4, 4])
    assert loop.mode == ("AUTO", "")


@pytest.mark.parametrize(
    "word",
    [
        "",
        " ",
        "NaN",
        "nan",
        "Bad",
        "NO DATA",
        "I/O Timeout",
        "Bad Input",
        "Pt Created",
        "inf",
        "-Inf",
        "<null>",
    ],
)
def test_words_of_the_historian_are_gaps(write, word):
    loop = read_recording(write(f"time,OP,PV\n0,1,{word}\n1,{word},3\n"))
    np.testing.assert_array_equal(np.isnan(loop.pv), [True, False])
    np.testing.assert_array_equal(np.isnan(loop.op), [False, True])


def test_without_time_column(write):
    loop = read_recording(write("OP,PV\n1,2\n3,4\n5,6\n"), Columns(ts=20.0))
    np.testing.assert_array_equal(loop.time, [0, 20, 40])


def test_duplicate_times_keep_the_first(write):
    loop = read_recording(write("time,OP,PV,mode\n0,1,1,A\n1,2,2,B\n1,9,9,C\n1,8,8,D\n2,3,3,E\n"))
    np.testing.assert_array_equal(loop.op, [1, 2, 3])
    assert loop.mode == ("A", "B", "E")
    assert loop.duplicates == 2


@pytest.mark.parametrize(("delimiter", "bom"), [(";", ""), ("\t", ""), (",", "\ufeff")])
def test_spreadsheets_own_habits(write, delimiter, bom):
    text = bom + "\r\n".join(delimiter.join(row) for row in (["time", "OP", "PV"], ["0", "1", "2"], []))
    assert read_recording(write(text)).pv[0] == 2


def test_cell_with_text_names_file_line_and_expectation(write):
    message = fault(write("time,OP,PV\n\n0,1,2\n1,1,open\n"))
    assert "line 4" in message
    assert "'open'" in message
    assert "expected a number" in message


def test_backward_time(write):
    assert "line 4: time runs backward by 5 s" in fault(write("time,OP,PV\n0,1,2\n9,1,2\n4,1,2\n"))


@pytest.mark.parametrize("stamp", ["", "Bad", "NaN"])
def test_sample_without_time(write, stamp):
    assert "line 3: time is missing" in fault(write(f"time,OP,PV\n0,1,2\n{stamp},1,2\n"))
    assert "line 2: time is missing" in fault(write(f"time,OP,PV\n{stamp},1,2\n"))


def test_times_of_two_kinds(write):
    assert "line 3" in fault(write("time,OP,PV\n0,1,2\n2026-01-01,1,2\n"))
    assert "line 3" in fault(write("time,OP,PV\n2026-01-01,1,2\n5 o'clock,1,2\n"))


def test_missing_column_lists_what_is_there(write):
    message = fault(write("time,OP,FLOW\n0,1,2\n"))
    assert "'PV'" in message
    assert "time, OP, FLOW" in message
    assert "--pv" in message
    assert "--ts" in fault(write("OP,PV\n1,2\n"))
    assert "'SPT'" in fault(write("time,OP,PV\n0,1,2\n"), Columns(sp="SPT"))
    assert "'md'" in fault(write("time,OP,PV\n0,1,2\n"), Columns(mode="md"))


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "empty"),
        (b"\n\n  \n", "empty"),
        (b"time,OP,PV\n", "no samples"),
        (bytes(range(256)) * 8, "UTF-8"),
        (b"\0\1\2\3", "binary"),
        (b"time,OP,PV\n0,1\n", "line 2: 2 cells, expected 3"),
        (b"time,OP,PV\n0,1,5,2,5\n", "decimal comma"),
        (b"time,OP,PV,PV\n0,1,2,3\n", "twice"),
        (b'time,OP,PV\n0,1,"' + b"x" * (1 << 21) + b'"\n', "CSV"),
    ],
)
def test_refused_files(write, content, expected):
    assert expected in fault(write(content))


def test_unreadable_files(tmp_path):
    assert "No such file" in fault(tmp_path / "none.csv")
    assert "directory" in fault(tmp_path).lower()


def test_trailing_delimiters_are_no_cells(write):
    assert len(read_recording(write("time,OP,PV\n0,1,2,,\n")).op) == 1


def parquet(path, **columns):
    pq.write_table(pa.table(columns), path)
    return path


def test_parquet(tmp_path):
    stamps = pa.array([1_000_000, 2_000_000], pa.timestamp("us", tz="UTC"))
    path = parquet(tmp_path / "LIC7.parquet", time=stamps, OP=pa.array([1, None]), PV=["2.5", "No Data"])
    loop = read_recording(path)
    np.testing.assert_array_equal(loop.time, [1, 2])
    np.testing.assert_array_equal(loop.op, [1, math.nan])
    np.testing.assert_array_equal(loop.pv, [2.5, math.nan])


def test_parquet_faults(tmp_path, write):
    path = parquet(tmp_path / "a.parquet", time=[0.0, 1.0], OP=[1.0, 2.0], PV=["1", "shut"])
    assert "row 2" in fault(path)
    assert "Parquet" in fault(write("time,OP,PV\n0,1,2\n", "b.parquet"))
    assert "Parquet" in fault(write(b"PAR1junkjunk", "c.csv"))


def test_hundred_thousand_rows_in_a_few_seconds(write):
    rows = "".join(f"{k},{k % 7}.25,{k % 11}.5\n" for k in range(100_000))
    assert len(read_recording(write("time,OP,PV\n" + rows)).pv) == 100_000


def test_industrial_recordings(recordings):
    flow = read_recording(recordings / "isdb" / "CHEM12.csv")
    assert len(flow.op) == 2000
    refinery = read_recording(recordings / "refinery" / "2111_FIC40102B_5.csv")
    assert refinery.sp is not None
    assert set(refinery.mode) == {"AUTO"}
    assert refinery.time[0] == datetime(2024, 8, 24, 21, 55, tzinfo=UTC).timestamp()


def test_a_long_text_that_is_stored_once_for_many_rows_is_refused_before_it_is_unpacked(tmp_path):
    n = 600_000
    words = pa.DictionaryArray.from_arrays(pa.array(np.zeros(n, np.int8)), pa.array(["x" * 2000]))
    path = tmp_path / "bomb.parquet"
    pq.write_table(pa.table({"time": np.arange(n, dtype=float), "OP": words}), path)
    assert path.stat().st_size < 6e6
    assert "unpacks to more than" in fault(path)


def test_a_column_of_lists_is_refused(tmp_path):
    path = tmp_path / "lists.parquet"
    pq.write_table(pa.table({"OP": pa.array([[0.0, 1.0]] * 10)}), path)
    assert "not list" in fault(path)
