"""What the daemon says on stderr, line by line."""

import io
import json
import logging
import os

import pytest

from agent.cli.common.logs import LogFormat, LogLevel, set_up

LOG = logging.getLogger("agent.runtime.example")


@pytest.fixture(autouse=True)
def restored():
    """Leave logging to pytest as it was."""
    root = logging.getLogger()
    handlers, level = root.handlers[:], root.level
    root.handlers[:] = []
    yield
    root.handlers[:] = handlers
    root.setLevel(level)
    logging.captureWarnings(capture=False)


def test_json_has_one_object_a_line_with_what_it_is_about():
    said = io.StringIO()
    set_up(LogFormat.JSON, LogLevel.INFO, said, {})
    LOG.info("%s is up", "connection bus", extra={"event": "up", "connection": "bus", "password": "s3cret"})
    LOG.debug("not told")
    try:
        _ = 1 / 0
    except ZeroDivisionError:
        LOG.exception("two\nlines", extra={"loop": "FIC101"})
    first, second = [json.loads(line) for line in said.getvalue().splitlines()]
    assert first.pop("time").endswith("+00:00")
    assert first == {
        "level": "info",
        "event": "up",
        "connection": "bus",
        "message": "connection bus is up",
    }
    assert (second["level"], second["loop"], second["message"]) == ("error", "FIC101", "two\nlines")
    assert "ZeroDivisionError" in second["exception"]
    assert "s3cret" not in said.getvalue()


def test_for_the_journal_each_line_bears_its_level_and_no_time(tmp_path):
    with (tmp_path / "journal").open("w+") as stream:
        there = os.fstat(stream.fileno())
        set_up(
            LogFormat.TEXT,
            LogLevel.DEBUG,
            stream,
            {"JOURNAL_STREAM": f"{there.st_dev}:{there.st_ino}"},
        )
        LOG.debug("a")
        LOG.info("b")
        LOG.warning("c\nd")
        LOG.error("e")
        stream.seek(0)
        assert stream.read().splitlines() == ["<7>a", "<6>b", "<4>c", "<4>d", "<3>e"]


def test_libraries_that_write_passwords_stay_shut_at_every_level():
    said = io.StringIO()
    set_up(LogFormat.TEXT, LogLevel.DEBUG, said, {})
    for library in ("asyncua.client", "pymodbus.logging", "mqtt", "aiomqtt"):
        logging.getLogger(library).error("password s3cret")
    assert said.getvalue() == ""
