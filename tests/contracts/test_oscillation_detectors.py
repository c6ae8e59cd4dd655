"""What every oscillation detector promises: agent/checks/oscillation_detectors.py."""

import pytest

from agent.analysis.oscillation import DETECTORS
from agent.checks import checks_of

PAIRS = [
    (detector, check) for detector in DETECTORS for check in checks_of("oscillation_detectors", detector)
]


def test_names_are_distinct():
    assert len({detector.name for detector in DETECTORS}) == len(DETECTORS)


def test_some_detectors_are_proof_against_noise():
    assert any(detector.noise_proof for detector in DETECTORS)


@pytest.mark.parametrize(
    ("detector", "check"), PAIRS, ids=[f"{detector.name}-{check.name}" for detector, check in PAIRS]
)
def test_contract(detector, check):
    check(detector)
