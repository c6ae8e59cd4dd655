"""SIGKILL at random moments: no alarm is lost, none is doubled for a consumer that honours the id.

Another agent stands by and takes over each time.
"""

import json
import random
import subprocess
import sys
import time

import pytest

from tests.conftest import ROOT


@pytest.mark.parametrize(
    "kills",
    [
        pytest.param(1, marks=pytest.mark.timeout(240)),
        pytest.param(25, marks=[pytest.mark.bench, pytest.mark.timeout(600)]),
    ],
)
def test_alarms_survive_sigkill(tmp_path, kills):
    store, peer, chance = tmp_path / "plant.sqlite", tmp_path / "peer", random.Random(kills)

    def started(task):
        return subprocess.Popen(
            [sys.executable, "-m", "tests.faults.killed_program", str(store), str(peer), task],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            text=True,
        )

    standby = started("work")
    for kill in range(kills):
        with standby as program:
            assert program.stdout.readline() == "ready\n"
            standby = started("work" if kill < kills - 1 else "drain")
            deadline = time.monotonic() + 60
            while kill == 0 and (not peer.exists() or peer.read_text().count("\n") < 20):
                assert time.monotonic() < deadline
                time.sleep(0.01)
            time.sleep(chance.uniform(0, 0.4))  # it works meanwhile, and dies wherever it is
            program.kill()
    with standby as program:
        assert program.stdout.readline() == "ready\n"
        windows = int(program.stdout.readline())
    told = [json.loads(line) for line in peer.read_text().splitlines()]
    events = [fields for kind, fields in told if kind == "event"]
    once = list({fields["message_id"]: fields for fields in events}.values())
    assert [fields["time"] for fields in once] == list(range(1, windows + 1))
    assert [fields["active"] for fields in once] == [bool(k % 2) for k in range(1, windows + 1)]
    assert windows > kills
    assert len(events) > len(once)  # the peer did get some twice
    sequences = [fields["sequence"] for fields in once]
    assert sequences == sorted(set(sequences))
    states = [fields for kind, fields in told if kind == "state"]
    assert states[-1]["time"] == windows
    assert not store.with_name("plant.sqlite-wal").exists()  # the last one closed it
