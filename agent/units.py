"""The two ways to name a valve's stiction, and the conversions between them.

Source: reference ``methods.md`` 1.1; Lee, Ren and Huang (2008), section V.C.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class FrictionBands:
    """Friction of a valve in the unit of OP, after He et al. (2007)."""

    f_s: float
    """Static friction band, OP units; a resting valve starts when the force exceeds it."""
    f_d: float
    """Kinetic friction band, OP units; the friction of a moving valve. 0 <= f_d <= f_s."""

    @property
    def s(self) -> float:
        """Dead band plus stick band S = f_S + f_D, OP units."""
        return self.f_s + self.f_d

    @property
    def j(self) -> float:
        """Slip jump J = f_S - f_D, OP units; OP travels as far from slip to slip, the stick band."""
        return self.f_s - self.f_d

    @property
    def dead_band(self) -> float:
        """Dead band 2 f_D, OP units: travel of OP that a reversal loses beyond the stick band."""
        return 2 * self.f_d

    @classmethod
    def from_s_j(cls, s: float, j: float) -> FrictionBands:
        """Bands of the valve that Choudhury and Kano describe by S and J (both OP units)."""
        return cls(f_s=(s + j) / 2, f_d=(s - j) / 2)
