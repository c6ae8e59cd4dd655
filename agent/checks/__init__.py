"""Checks for members of your own: an effect, a process, a stiction law, a detector or a quantifier.

They demand what the contract tests of slipjump demand of its own members, and need neither pytest nor
hypothesis::

    from agent.checks import check_all, checks_of

    check_all("effects", SplitRange())  # raises ContractError with one sentence for each fault

With pytest one test per check::

    @pytest.mark.parametrize("check", checks_of("effects", SplitRange()), ids=lambda check: check.name)
    def test_contract(check):
        check(SplitRange())
"""

from __future__ import annotations

from importlib import import_module
from typing import Literal

from agent.checks.contract import Check, ContractError

__all__ = ["FAMILIES", "Check", "ContractError", "Family", "check_all", "checks_of", "faults_of"]

Family = Literal[
    "effects", "processes", "stiction_laws", "oscillation_detectors", "stiction_detectors", "quantifiers"
]
FAMILIES: tuple[Family, ...] = (
    "effects",
    "processes",
    "stiction_laws",
    "oscillation_detectors",
    "stiction_detectors",
    "quantifiers",
)
"""Each has its checks in the file of that name."""


def checks_of(family: Family, member: object = None) -> tuple[Check, ...]:
    """Return all checks of a family; those that apply to ``member`` where one is given.

    Raises:
        ValueError: There is no such family; the text lists those that there are.
    """
    if family not in FAMILIES:
        raise ValueError(f"no family {family!r}; there are {', '.join(FAMILIES)}")
    found: tuple[Check, ...] = import_module(f"{__name__}.{family}").CHECKS
    return found if member is None else tuple(each for each in found if each.applies(member))


def faults_of(family: Family, member: object) -> tuple[str, ...]:
    """Return a sentence for each demand that a member does not meet; empty where it keeps its contract."""
    faults = []
    for check in checks_of(family):
        try:
            check(member)
        except ContractError as error:
            faults.append(str(error))
    return tuple(faults)


def check_all(family: Family, member: object) -> None:
    """Check all that the contract of a family demands of a member.

    Raises:
        ContractError: It does not meet some demands; the text has a line for each.
    """
    faults = faults_of(family, member)
    if faults:
        raise ContractError("\n".join(faults))
