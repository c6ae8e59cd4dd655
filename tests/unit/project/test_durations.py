"""Durations as people say them."""

import pytest

from agent.durations import duration_words


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.0, "0 s"),
        (0.0123, "0.0123 s"),
        (119.0, "119 s"),
        (600.0, "10 min"),
        (7140.0, "119 min"),
        (9000.0, "2.5 h"),
        (46080.0, "12.8 h"),
        (259200.0, "3 days"),
    ],
)
def test_a_duration_has_the_unit_in_which_it_is_read_best(seconds, words):
    assert duration_words(seconds) == words
