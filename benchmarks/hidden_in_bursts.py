"""The loops of ``hidden_effects`` where noise and loads come in bursts, as those of real recordings do.

Their innovations have heavy tails. The strength is that of ``surroundings``, in bursts, 0.6.
"""

from __future__ import annotations

from benchmarks import hidden_effects
from benchmarks.cases.options import Options

FIRST_SEED = 91410
BURSTS = 0.6
"""Standard deviation of the logarithm of how strong they are."""


def run(options: Options) -> None:
    """Print the tables of ``hidden_effects``."""
    hidden_effects.run(options, "hidden_in_bursts", FIRST_SEED, BURSTS)
