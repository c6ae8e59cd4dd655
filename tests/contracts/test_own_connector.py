"""A bus that a package of its own offers is picked up by the contract tests, and its faults are found."""

import os
import subprocess
import sys

import pytest
from toy_bus import TOY, Careless, Deaf, Forgetful, Stubborn, ToyPeer, kind_of

from connectors import kinds
from connectors.checks import checks_of
from connectors.checks.garbage import garbage_is_a_loss
from connectors.checks.losses import a_lost_peer_is_reported, nothing_is_lost_after_a_reconnect
from connectors.checks.sessions import reading_ends_when_cancelled
from simulators.servers.peers import PEERS, peers_of
from tests.conftest import ROOT


@pytest.fixture
def package(tmp_path):
    """A folder with the metadata of an installed package that offers the toy bus."""
    metadata = tmp_path / "toy_bus-1.dist-info"
    metadata.mkdir()
    (metadata / "METADATA").write_text("Metadata-Version: 2.1\nName: toy-bus\nVersion: 1\n")
    (metadata / "entry_points.txt").write_text(f"[{kinds.ENTRY_POINTS}]\ntoy = toy_bus:TOY\n")
    return tmp_path


def test_every_check_runs_for_a_kind_of_another_package(package):
    paths = (str(package), str(ROOT / "tests" / "contracts"), str(ROOT))
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-rA", "-k", "toy and not often",
         "tests/contracts/test_connector_kinds.py"],
        cwd=ROOT, env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True, text=True, check=False, timeout=200,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    missed = [check.__name__ for check in checks_of(TOY) if f"PASSED {_item(check)}" not in done.stdout]
    assert missed == []


def _item(check):
    return f"tests/contracts/test_connector_kinds.py::test_contract[toy-{check.__name__}]"


@pytest.mark.parametrize(
    ("fault", "check", "sentence"),
    [
        (Forgetful, nothing_is_lost_after_a_reconnect, "was not read|samples were lost"),
        (Stubborn, reading_ends_when_cancelled, "did not end within 1 s of its cancellation"),
        (
            Deaf,
            a_lost_peer_is_reported,
            "reading from a peer that is gone: no ConnectionLostError within",
        ),
        (Careless, garbage_is_a_loss, "garbage number 1 raised .*, expected ConnectionLostError"),
    ],
)
async def test_a_faulty_connector_is_caught(fault, check, sentence, monkeypatch):
    monkeypatch.setattr("connectors.checks.session.DEADLINE", 1.0)
    monkeypatch.setattr("connectors.checks.losses.DEADLINE", 1.0)
    monkeypatch.setattr("connectors.checks.sessions.PROMPT", 1.0)
    await check(TOY, ToyPeer)
    with pytest.raises(AssertionError, match=sentence):
        await check(kind_of(fault), ToyPeer)


def test_a_kind_that_exists_is_refused(monkeypatch):
    class Offer:
        value = "toy_bus:TOY"

        @staticmethod
        def load():
            return kinds.KINDS[0]

    monkeypatch.setattr(kinds, "entry_points", lambda group: [Offer] if group == kinds.ENTRY_POINTS else [])
    with pytest.raises(ValueError, match="toy_bus:TOY offers a connector of kind 'modbus', which exists"):
        kinds._installed()


def test_every_kind_built_in_has_a_peer_and_one_without_is_named():
    assert PEERS.keys() == {kind.kind for kind in kinds.BUILT_IN}
    with pytest.raises(LookupError, match="kind 'toy' has no peers"):
        peers_of(kinds.ConnectorKind("toy", TOY.options, TOY.tag, TOY.target, TOY.open))
