"""What a check is: a function of one member, with what the contract of its family demands in one sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from agent.physics.foreign import file_of


class ContractError(AssertionError):
    """A member breaks the contract of its family; the text names the member, the demand and the value."""


def require(holds: object, found: str) -> None:
    """Go on where something holds.

    Args:
        holds: Any truth value, also that of numpy.
        found: What the member does instead, for an engineer.

    Raises:
        ContractError: It does not hold.
    """
    if not holds:
        raise ContractError(found)


@dataclass(frozen=True, slots=True)
class Check:
    """One demand of a contract, as a function of the member."""

    family: str
    """``effect``, ``process``, ... : as ``checks.FAMILIES`` names it, in the singular."""
    demand: str
    """What the contract demands, a clause after the name of the member."""
    run: Callable[[Any], None]
    applies: Callable[[Any], bool]
    """Whether the contract makes this demand of a member."""

    @property
    def name(self) -> str:
        """Short name, an identifier."""
        return self.run.__name__

    def __call__(self, member: object) -> None:
        """Check one member; one of which the contract does not demand it passes.

        Raises:
            ContractError: It breaks the contract, or raised an error where the contract allows none.
        """
        try:
            if self.applies(member):
                self.run(member)
        except ContractError as error:
            raise ContractError(f"{self._subject(member)} {self.demand}; {error}") from None
        except Exception as error:  # the code of somebody else may raise anything
            found = f"it raised {type(error).__name__}: {' '.join(str(error).split())}"
            raise ContractError(f"{self._subject(member)} {self.demand}; {found}") from error

    def _subject(self, member: object) -> str:
        return f"{self.family} {getattr(member, 'name', type(member).__name__)!s} ({file_of(member)})"


def demand(
    family: str, sentence: str, applies: Callable[[Any], bool] = lambda _: True
) -> Callable[[Callable[[Any], None]], Check]:
    """Make a check of a function that calls ``require``.

    Args:
        family: As ``Check.family``.
        sentence: As ``Check.demand``.
        applies: As ``Check.applies``.
    """
    return lambda run: Check(family, sentence, run, applies)


@contextmanager
def where(case: str) -> Iterator[None]:
    """Name the case in front of what was found in it.

    Raises:
        ContractError: Something was found.
    """
    try:
        yield
    except ContractError as error:
        raise ContractError(f"{case}: {error}") from None


def require_close(
    found: object, expected: object, what: str, *, rtol: float = 0.0, atol: float = 0.0
) -> None:
    """Go on where two arrays have one shape and are equal within a tolerance; NaN equals NaN.

    Raises:
        ContractError: They are not; the text says where they differ most.
    """
    one, other = np.asarray(found, dtype=np.float64), np.asarray(expected, dtype=np.float64)
    require(one.shape == other.shape, f"{what} has shape {one.shape}, expected {other.shape}")
    apart = ~np.isclose(one, other, rtol=rtol, atol=atol, equal_nan=True)
    if apart.any():
        at = tuple(int(place) for place in np.argwhere(apart)[0])
        place = f" at {', '.join(map(str, at))}" if at else ""
        raise ContractError(f"{what}{place} is {one[at]:.9g}, expected {other[at]:.9g}")
