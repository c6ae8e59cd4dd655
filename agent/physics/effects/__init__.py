"""Physical effects that a loop may have, one a file."""

from __future__ import annotations

from functools import cache
from importlib.metadata import entry_points

from agent.physics.effect import Effect
from agent.physics.effects.actuator_lag import ActuatorLag
from agent.physics.effects.asymmetric_stiction import AsymmetricStiction
from agent.physics.effects.characteristic import Characteristic
from agent.physics.effects.deadband import Deadband
from agent.physics.effects.gain_change import GainChange
from agent.physics.effects.integrating import Integrating
from agent.physics.effects.inverse_response import InverseResponse
from agent.physics.effects.load_step import LoadStepEffect
from agent.physics.effects.loss_curve import LossCurve
from agent.physics.effects.overflow import Overflow
from agent.physics.effects.process_friction import ProcessFriction
from agent.physics.effects.pv_gain import PvGain
from agent.physics.effects.rate_limit import RateLimit
from agent.physics.effects.saturation import Saturation
from agent.physics.effects.second_order import SecondOrder
from agent.physics.effects.sensor_deadband import SensorDeadband
from agent.physics.effects.sensor_lag import SensorLag
from agent.physics.effects.sinusoid import Sinusoid
from agent.physics.effects.split_range import SplitRange
from agent.physics.effects.square_law import SquareLaw
from agent.physics.effects.stiction import Stiction
from agent.physics.effects.titration import Titration
from agent.physics.effects.transport_delay import TransportDelay
from agent.physics.effects.wave import RepeatingWave

__all__ = ["EFFECTS", "ENTRY_POINTS", "Effect", "effects"]

EFFECTS: tuple[Effect, ...] = (
    Deadband(),
    Stiction(),
    AsymmetricStiction(),
    Saturation(),
    Characteristic(),
    SplitRange(),
    PvGain(),
    LossCurve(),
    SquareLaw(),
    Titration(),
    RateLimit(),
    ActuatorLag(),
    SecondOrder(),
    SensorLag(),
    SensorDeadband(),
    TransportDelay(),
    Integrating(),
    InverseResponse(),
    ProcessFriction(),
    Overflow(),
    Sinusoid(),
    RepeatingWave(),
    LoadStepEffect(),
    GainChange(),
)
"""Built in; the simplest member of a family comes first."""
ENTRY_POINTS = "slipjump.effects"
"""Group under which an installed package offers its own: docs/howto/own_effect.md."""


@cache
def effects() -> tuple[Effect, ...]:
    """Return the effects built in and those of installed packages.

    Raises:
        ValueError: Two have the same name; the message names the package.
    """
    known = {each.name: each for each in EFFECTS}
    for entry in entry_points(group=ENTRY_POINTS):
        own: Effect = entry.load()()
        if own.name in known:
            raise ValueError(f"{entry.value} offers an effect {own.name!r}, but this name is already in use")
        known[own.name] = own
    return tuple(known.values())
