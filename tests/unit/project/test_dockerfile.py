"""The Dockerfile, as far as it can be held to the rest without Docker."""

import re

from typer.testing import CliRunner

from agent.cli.commands import app
from agent.settings import HttpSettings
from tests.conftest import ROOT

LINES = (ROOT / "Dockerfile").read_text().replace("\\\n", " ")
UNIT = (ROOT / "config" / "systemd" / "slipjump.service").read_text()


def test_all_that_it_copies_is_there_and_sent_to_docker():
    sent = {line[1:] for line in (ROOT / ".dockerignore").read_text().splitlines() if line.startswith("!")}
    copied = set()
    for words in re.findall(r"^COPY (?!--from)(.*)$", LINES, re.MULTILINE):
        *sources, _ = words.split()
        copied |= set(sources)
    assert copied == sent
    assert all((ROOT / source).exists() for source in copied)


def test_it_runs_what_there_is_as_the_service_does():
    for command in re.findall(r'/bin/slipjump (\w+)|^CMD \["(\w+)"', LINES, re.MULTILINE):
        assert CliRunner().invoke(app, ["".join(command), "--help"]).exit_code == 0
    assert f":{HttpSettings().port}/live" in LINES
    settings = dict(re.findall(r"(OPENBLAS\w+)=(\S+)", UNIT))
    assert settings
    assert settings.items() <= dict(re.findall(r"(\w+)=(\S+)", LINES)).items()
