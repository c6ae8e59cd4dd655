"""The list of slow files names files, each once."""

from pathlib import Path

from tests.slow_files import SLOW_FILES, place

TESTS = Path(__file__).parents[2]


def test_each_is_a_file_and_comes_before_all_others():
    assert [each for each in SLOW_FILES if not (TESTS / each).is_file()] == []
    assert [place(each) for each in SLOW_FILES] == list(range(len(SLOW_FILES)))
    assert place("unit/project/test_slow_files.py") == len(SLOW_FILES)
