"""The unit file of systemd: it is understood, it restricts, and it starts what there is."""

import re
import shutil
import subprocess
import sys

import pytest
from typer.testing import CliRunner

from agent.cli.commands import app
from tests.conftest import ROOT

UNIT = ROOT / "config" / "systemd" / "slipjump.service"


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd is not installed")
def test_systemd_understands_it_and_finds_little_exposed(tmp_path):
    unit = tmp_path / "slipjump.service"
    program = re.search(r"^ExecStart=(\S+)", UNIT.read_text(), re.MULTILINE)[1]
    unit.write_text(UNIT.read_text().replace(program, sys.executable))
    seen = subprocess.run(["systemd-analyze", "verify", unit], capture_output=True, text=True, check=False)
    assert (seen.returncode, seen.stderr) == (0, "")
    words = ["systemd-analyze", "security", "--offline=yes", "--no-pager", "--threshold=15", unit]
    assert subprocess.run(words, capture_output=True, check=False).returncode == 0


def test_the_watchdog_leaves_time_for_three_signs_of_life():
    content = UNIT.read_text()
    assert "Type=notify\n" in content
    assert int(re.search(r"^WatchdogSec=(\d+)$", content, re.MULTILINE)[1]) >= 30
    command = re.search(r"^ExecStart=\S+/slipjump (\w+) ", content, re.MULTILINE)[1]
    assert CliRunner().invoke(app, [command, "--help"]).exit_code == 0
