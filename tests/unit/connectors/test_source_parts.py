"""Parts of sources: pages that overlap, values of a tag."""

import numpy as np
import pytest

from connectors.base import ConfigError
from connectors.exports.recorded import ReadOptions
from connectors.recording import loops_in, read_recording
from connectors.sources.collected import CollectedTag, Overlap


def test_overlapping_pages_give_each_value_once():
    stamps = [1, 2, 2, 3, 3, 3, 4, 5, 5, 6]
    for size in range(4, 12):
        page, taken = Overlap(size), []
        while True:
            rest = stamps if page.last is None else [each for each in stamps if each >= page.last]
            new = page.new(rest[:size])
            assert new is not None
            taken += [rest[k] for k in new]
            if not page.is_full(rest[:size]):
                break
        assert taken == stamps
    stuck = Overlap(2)
    assert list(stuck.new([3, 3])) == [0, 1]
    assert stuck.new([3, 3]) is None


def test_collected_values_are_numbers_gaps_or_words():
    tag = CollectedTag("x")
    for value in (1, 2.5, "3", "Bad", "open", None, float("inf"), True):
        tag.add(len(tag), value)
    tag.add(-1.0, 9, good=False)
    series = tag.series()
    np.testing.assert_array_equal(series.values, [np.nan, 1, 2.5, 3, np.nan, np.nan, np.nan, np.nan, 1])
    assert (series.time[0], tag.bad) == (-1.0, 5)
    mode = CollectedTag("x", mode=True)
    for value in ("AUTO", "MAN", "AUTO", 1.0, ""):
        mode.add(len(mode), value)
    assert mode.series().words == ("AUTO", "MAN", "1")


def test_a_span_cuts_a_file(tmp_path):
    path = tmp_path / "x.csv"
    path.write_text("time,OP,PV,mode\n" + "".join(f"{k},{k},{k},AUTO\n" for k in range(100)))
    read = read_recording(path, options=ReadOptions(span=(10.0, 20.0)))
    assert (read.time[0], read.time[-1], len(read.mode)) == (10.0, 19.0, 10)
    with pytest.raises(ConfigError, match="has no sample in the span"):
        read_recording(path, options=ReadOptions(span=(1000.0, 2000.0)))
    path.write_text("time,OP,PV\n0,nonsense,1\n1,2,3\n")  # what its columns are is known without their values
    assert loops_in(path, ReadOptions()) == ("x",)
