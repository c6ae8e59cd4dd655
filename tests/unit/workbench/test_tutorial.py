"""The tutorial does what it says."""

import doctest
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[3] / "docs" / "workbench" / "tutorial.md"


@pytest.mark.timeout(240)  # a cold cache of kernels takes a minute
def test_each_line_of_the_tutorial_gives_what_the_page_shows():
    text = PAGE.read_text(encoding="utf-8").replace("```", "")
    page = doctest.DocTestParser().get_doctest(text, {}, PAGE.name, str(PAGE), 0)
    assert len(page.examples) > 20
    said = []
    doctest.DocTestRunner().run(page, out=said.append)
    assert not said, "".join(said)
