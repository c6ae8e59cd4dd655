"""Exports as plants have them: read right without an option, or refused with the option that settles it."""

import numpy as np
import pytest

from connectors.exports.cells.times import TimeOptions
from connectors.exports.fault import RecordingError
from connectors.exports.mapping import mapping_text, with_mapping
from connectors.exports.reading import read_export
from connectors.exports.recorded import Columns, ReadOptions
from tests.exports.corpus import CASES, HELD
from tests.exports.truth import TIME

READ = [case for case in CASES if not case.settles]
REFUSED = [case for case in CASES if case.settles]


def options(given):
    times = TimeOptions(given.get("zone"), given.get("form"), given.get("order"))
    return ReadOptions(Columns(ts=given.get("ts")), times, given.get("decimal"))


@pytest.fixture
def write(tmp_path):
    def _write(case):
        path = tmp_path / case.name
        path.write_bytes(case.content)
        return path

    return _write


def test_the_corpus_is_large_enough_and_few_files_need_an_option():
    assert len(CASES) >= 40
    assert len(READ) >= 38


@pytest.mark.parametrize("case", READ, ids=lambda case: case.name)
def test_read_without_an_option(case, write):
    check(case, read_export(write(case), options(case.options)))


@pytest.mark.parametrize("case", READ, ids=lambda case: case.name)
def test_the_mapping_that_import_writes_reads_the_same(case, write, tmp_path):
    path, given, mapping = write(case), options(case.options), tmp_path / "mapping.yaml"
    first = read_export(path, given)
    mapping.write_text(mapping_text(first, given), encoding="utf-8")
    again = read_export(path, with_mapping(given, mapping))
    assert again.loops.names == first.loops.names
    for one, other in zip(again.loops, first.loops, strict=True):
        np.testing.assert_allclose([one.pv, one.op], [other.pv, other.op])


@pytest.mark.parametrize("case", REFUSED, ids=lambda case: case.name)
def test_refused_with_the_option_that_settles_it(case, write):
    path = write(case)
    with pytest.raises(RecordingError) as refused:
        read_export(path)
    message = str(refused.value)
    assert case.names_option in message
    assert "\n" not in message
    check(case, read_export(path, options(case.settles)))


def check(case, export):
    assert len(export.loops) == len(case.loops)
    for read, true in zip(export.loops, case.loops, strict=True):
        if not case.single:
            assert read.name == true.name
        np.testing.assert_allclose(read.time, TIME if case.time is None else case.time, atol=2e-3)
        if case.settles.get("decimal"):
            np.testing.assert_allclose(read.op, np.round(10 + np.abs(true.op) % 80, 3))
            continue
        np.testing.assert_allclose(read.op, HELD if case.name == "interleaved.csv" else true.op)
        np.testing.assert_allclose(read.pv, true.pv_with_gaps if case.gaps else true.pv)
        if case.sp:
            np.testing.assert_allclose(read.sp, true.sp)
