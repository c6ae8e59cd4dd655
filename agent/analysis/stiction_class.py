"""The four regions of the space of stiction parameters: Lee, Ren and Huang (2008), Fig. 2."""

from __future__ import annotations

from agent.analysis.results import StictionClass
from agent.units import FrictionBands

WEAK = 0.05
"""S below this part of the OP span is weak stiction."""
SMALL = 0.2
"""A slip jump, or a dead band, below this part of S does not shape the behaviour."""


def stiction_class(bands: FrictionBands, op_span: float) -> StictionClass:
    """Name the behaviour of a valve with ``bands`` when OP spans ``op_span`` (both OP units).

    Dead band 2 f_D and slip jump J add up to S; what is small against S is left out of the name.
    """
    if bands.s < WEAK * op_span or bands.s <= 0:
        return "weak"
    if bands.j < SMALL * bands.s:
        return "dead_band"
    if bands.dead_band < SMALL * bands.s:
        return "stick_slip"
    return "dead_band_stick_slip"
