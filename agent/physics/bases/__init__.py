"""Process bases: the process with which a model of the workbench begins, each kind with a name."""

from __future__ import annotations

from agent.physics.bases.base import Base
from agent.physics.bases.heat_exchanger import HeatExchangerBase
from agent.physics.bases.heater import HeaterBase
from agent.physics.bases.lag_bases import Fopdt, Integrator, LagsIntegrator, Sopdt
from agent.physics.bases.neutralisation import NeutralisationBase
from agent.physics.bases.oscillatory import Oscillatory
from agent.physics.bases.third_order import ThirdOrder
from agent.physics.bases.two_tanks import TwoTanksBase

__all__ = ["BASES", "Base"]

BASES: tuple[Base, ...] = (
    Fopdt(),
    Sopdt(),
    Integrator(),
    LagsIntegrator(),
    Oscillatory(),
    ThirdOrder(),
    TwoTanksBase(),
    HeaterBase(),
    HeatExchangerBase(),
    NeutralisationBase(),
)
