"""Numbers as they are printed: no sign before zero, and no share that is not zero printed as zero."""

import pytest

from agent.report.numbers import share_words, tenths


@pytest.mark.parametrize(
    ("value", "words"), [(-0.04, "0.0"), (0.0, "0.0"), (-0.06, "-0.1"), (95.56, "95.6"), (-20.0, "-20.0")]
)
def test_tenths(value, words):
    assert tenths(value) == words


@pytest.mark.parametrize(
    ("share", "words"), [(0.0, "0 %"), (0.0021, "0.2 %"), (0.0149, "1 %"), (0.154, "15 %"), (1.0, "100 %")]
)
def test_shares(share, words):
    assert share_words(share) == words
