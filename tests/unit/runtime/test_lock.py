"""One agent a state file, however the former one ended."""

import os
import signal
import subprocess
import sys

import pytest

from agent.runtime.store.lock import only_agent_of
from connectors.base import ConfigError
from tests.conftest import ROOT

HOLDER = """
import subprocess, sys
from pathlib import Path
from agent.runtime.store.lock import only_agent_of

with only_agent_of(Path(sys.argv[1])):
    child = subprocess.Popen(["sleep", "60"], close_fds=False)
    print("held", child.pid, flush=True)
    sys.stdin.read()
"""


def test_a_second_agent_reports_who_the_first_is_and_comes_when_that_is_killed(tmp_path):
    state = tmp_path / "plant.sqlite"
    with subprocess.Popen(
        [sys.executable, "-c", HOLDER, state],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as first:
        held, child = first.stdout.readline().split()
        assert held == "held"
        message = f"{state}: is used by another agent, process {first.pid}"
        with pytest.raises(ConfigError, match=message), only_agent_of(state):
            pytest.fail("two agents share a state file")
        with only_agent_of(tmp_path / "other.sqlite"):
            pass
        first.kill()
    try:
        os.kill(int(child), 0)  # as a worker, it outlives the agent for a while, and holds no lock
        with only_agent_of(state):
            assert (tmp_path / "plant.sqlite.lock").read_text() == f"{os.getpid()}\n"
    finally:
        os.kill(int(child), signal.SIGKILL)


def test_a_folder_that_takes_no_file_stops_no_agent(tmp_path, caplog):
    with only_agent_of(tmp_path / "not yet" / "plant.sqlite"):
        assert "cannot check whether another agent" in caplog.text
