"""Each command's help ends with examples; a dead time is samples, or a time with its unit."""

from __future__ import annotations

import shlex

import pytest
import typer
from typer.testing import CliRunner

from agent.cli.commands import COMMANDS, app
from agent.cli.common.delay import delay_of
from agent.cli.common.examples import EXAMPLES


@pytest.mark.parametrize("command", [each.__name__.rstrip("_") for each in COMMANDS] + ["alarms"])
def test_every_command_has_an_example_with_options_that_it_has(command):
    shown = CliRunner().invoke(app, [command, "--help"], terminal_width=200).output
    assert "Examples:" in shown
    for line in EXAMPLES[command]:
        words = shlex.split(line.partition("  (")[0])
        assert words[:2] == ["slipjump", command]
        assert line.split("  (")[0] in " ".join(shown.split())
        if command != "alarms":
            assert all(word in shown for word in words if word.startswith("-"))


@pytest.mark.parametrize(
    ("text", "ts", "samples"),
    [
        ("4", 2.0, 4),
        ("17s", 1.0, 17),
        ("17 s", 5.0, 3),
        ("2min", 10.0, 12),
        ("500ms", 0.1, 5),
        ("0.5s", 2.0, 1),
        ("1h", 60.0, 60),
        ("1.5 MIN", 30.0, 3),
    ],
)
def test_a_delay_in_samples_or_with_a_unit(text, ts, samples):
    assert delay_of(text).at(ts) == samples


@pytest.mark.parametrize(
    ("text", "ts", "said"),
    [
        ("0.2s", 1.0, ["--delay: 0.2 s of records every 1 s was taken as 1 sample, the least that there is"]),
        ("17s", 5.0, ["--delay: 17 s of records every 5 s was taken as 3 samples"]),
        ("1.4s", 1.0, ["--delay: 1.4 s of records every 1 s was taken as 1 sample"]),
        ("17s", 1.00001, []),
        ("500ms", 0.1, []),
        ("4", 2.0, []),
    ],
)
def test_a_time_that_is_no_whole_number_of_samples_is_said(text, ts, said):
    assert list(delay_of(text).remarks(ts)) == said


@pytest.mark.parametrize("text", ["", "0", "-3", "1.5", "5 parsec", "s", "nan", "1e3s"])
def test_what_is_no_delay_is_refused_with_what_is_expected(text):
    with pytest.raises(typer.BadParameter, match="17s"):
        delay_of(text)
