"""Process bases: the process with which a model of the workbench begins, each kind with a name."""

from __future__ import annotations

from agent.physics.bases.base import Base
from agent.physics.bases.lag_bases import Fopdt, Integrator, Sopdt
from agent.physics.bases.oscillatory import Oscillatory
from agent.physics.bases.two_tanks import TwoTanksBase

__all__ = ["BASES", "Base"]

BASES: tuple[Base, ...] = (Fopdt(), Sopdt(), Integrator(), Oscillatory(), TwoTanksBase())
