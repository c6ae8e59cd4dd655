"""``slipjump serve`` as the how-to prints it: simulated loops on a real server, watched and alarmed."""

import asyncio
import json
import re
import shlex
import sys

import pytest
import yaml

from agent.runtime.commission.probe import probe
from agent.settings.load import load_settings
from simulators.hidden_faults import FOLDER, TRUTH, shipped, truth_of
from tests.conftest import ROOT
from tests.docs.page import blocks
from tests.integration.command import slipjump

PAGE = [
    command
    for block in blocks((ROOT / "docs" / "howto" / "serve.md").read_text(encoding="utf-8"))
    if block.kind == "console"
    for command, _ in block.commands
]
LOOPS = ("fic101_stick_slip", "workbench/wb104")


class Running:
    """A command that goes on until it is ended."""

    def __init__(self, process):
        self.process = process

    @classmethod
    async def start(cls, *words, cwd):
        code = "from agent.cli import main; main()"
        return cls(
            await asyncio.create_subprocess_exec(
                sys.executable, "-c", code, *words, cwd=cwd, stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.STDOUT,
            )
        )  # fmt: skip

    async def line(self, pattern):
        while True:
            line = (await asyncio.wait_for(self.process.stdout.readline(), 60)).decode()
            assert line, f"it ended before {pattern}"
            if re.search(pattern, line):
                return line.strip()

    async def end(self):
        self.process.terminate()
        rest, _ = await asyncio.wait_for(self.process.communicate(), 30)
        return self.process.returncode, rest.decode()


@pytest.mark.parametrize(("bus", "scheme"), [("opcua", "opc.tcp"), ("modbus", "modbus"), ("mqtt", "mqtt")])
async def test_clients_read_the_loops_at_the_address_that_is_printed(tmp_path, bus, scheme):
    serving = await Running.start("serve", *LOOPS, "--bus", bus, "--config", "plant.yaml", cwd=tmp_path)
    try:
        assert re.fullmatch(rf"address: {scheme}://127\.0\.0\.1:\d+/", await serving.line("^address"))
        await serving.line("^watch them")
        found = await probe(load_settings(tmp_path / "plant.yaml"), 20.0)
        assert [problem for each in found for problem in each.problems] == []
        assert {each.loop for each in found if each.what == "tag"} == {"FIC101", "WB104"}
    finally:
        code, rest = await serving.end()
    assert (code, "Traceback" in rest) == (0, False)


async def test_all_faults_are_said_at_once(tmp_path):
    twice = str(FOLDER / "fic101_stick_slip.yaml")
    code, out, err = await slipjump("serve", "nowhere", "fic101_stick_slip", twice)
    assert (code, out) == (2, "")
    assert [line.partition(": ")[2] for line in err.splitlines()] == [
        "nowhere: no such file, and no scenario of `slipjump serve --list`",
        "FIC101: 2 scenarios are called so",
    ]
    code, _, err = await slipjump("serve", "fic101_stick_slip", "--config", tmp_path / "no" / "x.yaml")
    assert (code, "No such file" in err) == (2, True)


async def test_it_ends_by_itself_and_a_port_in_use_is_said(tmp_path):
    serving = await Running.start("serve", LOOPS[0], "--bus", "modbus", cwd=tmp_path)
    try:
        port = re.search(r":(\d+)/", await serving.line("^address"))[1]
        code, _, err = await slipjump("serve", LOOPS[0], "--bus", "modbus", "--port", port)
        assert (code, port in err) == (2, True)
        code, out, _ = await slipjump("serve", LOOPS[0], "--bus", "modbus", "--seconds", "0.2")
        assert (code, out.startswith("address: ")) == (0, True)  # on another port
    finally:
        await serving.end()


def test_the_truth_of_each_scenario_that_ships_is_written_down():
    written = yaml.safe_load((FOLDER / TRUTH).read_text(encoding="utf-8"))
    assert written == json.loads(json.dumps(truth_of())), "run python -m simulators.hidden_faults"
    assert set(written) == set(shipped())
    hidden = {fault for each in written.values() for fault in each["faults"]}
    assert len(hidden) >= 10


@pytest.mark.bench
@pytest.mark.timeout(600)
async def test_from_the_loop_to_the_alarm_as_the_page_prints_it(tmp_path):
    serve, run, listed, acknowledge = (shlex.split(each)[1:] for each in PAGE[1:])
    serving = await Running.start(*serve, cwd=tmp_path)
    await serving.line("^watch them")
    watching = await Running.start(*run, cwd=tmp_path)
    try:
        await watching.line("watching 2 loops")
        async with asyncio.timeout(400):
            assert (await _with("unacked_active", tmp_path, *listed)).startswith("FIC101")
            await _at(tmp_path, *acknowledge)
            text = await _with(" acked_active", tmp_path, *listed)
        assert "jane" in text
    finally:
        await watching.end()
        await serving.end()


async def _with(word, folder, *words):
    """The line of a command's output that has a word, as soon as there is one."""
    while True:
        for line in (await _at(folder, *words)).splitlines():
            if word in line:
                return line
        await asyncio.sleep(1)


async def _at(folder, *words):
    running = await Running.start(*words, cwd=folder)
    out, _ = await running.process.communicate()
    assert running.process.returncode == 0, out
    return out.decode()
