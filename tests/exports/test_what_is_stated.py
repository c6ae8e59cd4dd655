"""What a reader of an export takes for granted, leaves out or loses is stated, with its line."""

from datetime import UTC, datetime

import numpy as np
import pytest

from connectors.exports.cells.summer_time import skipped_hour
from connectors.exports.cells.times import TimeOptions
from connectors.exports.fault import RecordingError
from connectors.exports.mapping import mapping_text, with_mapping
from connectors.exports.reading import names_of_loops, read_export
from connectors.exports.recorded import ReadOptions
from tests.exports.layouts import BERLIN, autumn, iso, newest_first, plain, stamps, strf, zipped
from tests.exports.truth import LOOPS, N

ISO = stamps(iso)


def rows_of(content):
    return content.decode().splitlines()


def written(path, rows):
    path.write_text("\n".join([*rows, ""]), encoding="utf-8")
    return path


def test_a_row_without_a_readable_time_is_named_by_its_line(tmp_path):
    rows = rows_of(plain(ISO))
    rows[100] = "gateway down" + rows[100][len(ISO[0]) :]
    rows[150] = rows[150][len(ISO[0]) :]
    export = read_export(written(tmp_path / "FIC101.csv", rows))
    assert len(export.loops[0].time) == len(ISO) - 2
    assert export.problems == (
        "line 101: time is 'gateway down', no time that can be read; the row is a gap (1 more)",
    )


def test_a_second_column_of_a_role_is_left_out_and_named(tmp_path):
    rows = ["time,FIC101.PV,FIC101.MEAS,FIC101.OP", *(f"{each},1,2,3" for each in ISO)]
    export = read_export(written(tmp_path / "export.csv", rows))
    assert export.loops[0].tags == {"PV": "FIC101.PV", "OP": "FIC101.OP"}
    assert export.problems == (
        "FIC101.MEAS: was left out, FIC101.PV was taken for PV of FIC101; --mapping takes another",
    )


def test_a_second_tag_of_a_role_is_left_out_and_named(tmp_path):
    rows = ["tag,time,value"]
    rows += [f"FIC101.{tag},{each},{k}" for k, tag in enumerate(("PV", "MEAS", "OP")) for each in ISO]
    export = read_export(written(tmp_path / "export.csv", rows))
    assert export.loops[0].pv.tolist() == [0.0] * len(ISO)
    assert any("FIC101.MEAS: was left out" in each for each in export.problems)


def test_time_that_runs_backward_is_named_by_its_line_also_where_the_newest_row_is_first(tmp_path):
    _, local = autumn()
    rows = rows_of(newest_first(plain(local)))
    back = next(k for k in range(2, len(rows)) if rows[k] > rows[k - 1])
    with pytest.raises(RecordingError, match=rf"line {back}: time runs backward by 3585 s.*--zone"):
        read_export(written(tmp_path / "FIC101.csv", rows))


def test_the_hour_that_summer_time_skips_is_named_where_no_zone_is_stated(tmp_path):
    spring = datetime(2026, 3, 29, 0, 30, tzinfo=UTC).timestamp() + 15.0 * np.arange(N)
    rows = rows_of(plain(stamps(strf("%Y-%m-%d %H:%M:%S"), BERLIN, spring)))
    path = written(tmp_path / "FIC101.csv", rows)
    (problem,) = read_export(path).problems
    assert problem.startswith("time: the hour before 2026-03-29 03:00 is absent")
    assert "--zone" in problem
    read = read_export(path, ReadOptions(times=TimeOptions("Europe/Berlin")))
    np.testing.assert_allclose(read.loops[0].time, spring)
    assert not read.problems
    assert skipped_hour(np.array([*spring[:100], *(spring[100:] + 3600.0)]) - 3 * 3600.0) is None


def test_what_is_no_table_is_not_said_to_have_names(tmp_path):
    with pytest.raises(RecordingError, match="expected a line of column names"):
        read_export(written(tmp_path / "FIC101.csv", ['[{"time": 1, "OP": 2, "PV": 3}]']))


def test_tables_of_an_archive_with_the_same_loop_are_named_by_their_folders(tmp_path):
    path = tmp_path / "export.zip"
    days = {f"{day}/FIC101.csv": plain(ISO, LOOPS[0]) for day in ("day1", "day2")}
    path.write_bytes(zipped(**days, **{"day2/broken.csv": b"time,OP,PV\n1,2,3\n2,a,4\n"}))
    export = read_export(path)
    assert [each.name for each in export.loops] == ["day1_FIC101", "day2_FIC101"]
    assert names_of_loops(path) == ("day1_FIC101", "day2_FIC101")
    (problem,) = export.problems
    assert problem.startswith(f"{path}/day2/broken.csv, line 3: OP is 'a'")
    mapping = tmp_path / "export.yaml"
    mapping.write_text(mapping_text(export, ReadOptions()), encoding="utf-8")
    again = read_export(path, with_mapping(ReadOptions(), mapping))
    assert [each.name for each in again.loops] == ["day1_FIC101", "day2_FIC101"]


def test_what_is_no_table_in_an_archive_hides_no_loop(tmp_path):
    path = tmp_path / "export.zip"
    table = b"time,OP,PV\n" + b"".join(b"%d,%d,%d\n" % (k, k % 7, k % 5) for k in range(60))
    path.write_bytes(zipped(**{"FIC101.csv": table, "FIC102.csv": table, "notes.txt": b"no table"}))
    assert names_of_loops(path) == read_export(path).loops.names == ("FIC101", "FIC102")
