"""The line of progress of a conversation: a thread redraws it, so it must not be there while a user types."""

import io
import sys

import pytest

from agent.cli.comparing import guide
from agent.cli.comparing.hooks import TerminalProgress


class Terminal(io.StringIO):
    """A stream that says it is a terminal."""

    def isatty(self):
        return True


@pytest.fixture
def progress(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    return TerminalProgress()


def drawn(progress):
    """Whether a thread redraws the line."""
    return progress._bar.live.is_started


def test_it_is_drawn_while_something_is_tried_only(progress):
    assert not drawn(progress)
    progress("load_step", 0, 3)
    assert drawn(progress)
    progress.rest()
    assert not drawn(progress)
    progress("load_step", 1, 3)
    assert drawn(progress)
    progress.rest()


def test_without_a_terminal_nothing_is_drawn(monkeypatch):
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    progress = TerminalProgress()
    progress("load_step", 0, 3)
    assert not drawn(progress)


def test_a_conversation_reads_and_prints_without_it(progress, monkeypatch):
    seen = []
    monkeypatch.setattr(guide, "_read", lambda _: seen.append(drawn(progress)))
    monkeypatch.setattr(guide, "_show", lambda _: seen.append(drawn(progress)))
    read, show = guide.quietly(progress)
    progress("load_step", 0, 3)
    show("a line")
    progress("load_step", 1, 3)
    read("a prompt")
    assert seen == [False, False]
