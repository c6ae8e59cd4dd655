"""Values kept small while nobody needs them: their arrays of numbers as floats of 32 bits.

The rings have no more than 32 bits: a window loses nothing, and a curve of a model what no picture shows.
"""

from __future__ import annotations

import io
import pickle
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Self, TypeVar

import numpy as np

if TYPE_CHECKING:
    from agent.analysis.record.recording import FloatArray

T = TypeVar("T")
QUICK = 1
"""Level of zlib: higher ones save 2 % and take twice the time."""


@dataclass(frozen=True, slots=True)
class Packed(Generic[T]):
    """A value of dataclasses and arrays that nobody changes."""

    data: bytes
    squeezed: bool
    """Whether ``data`` are compressed."""

    @classmethod
    def of(cls, value: T, *, squeezed: bool = False) -> Self:
        """Pack a value.

        Args:
            value: Picklable; arrays of shape (n,) of 64-bit floats in it become such of 32 bits.
            squeezed: Whether it is compressed as well, which takes some 3 ms for a window of an hour.
        """
        text = io.BytesIO()
        _Packer(text, pickle.HIGHEST_PROTOCOL).dump(value)
        return cls(zlib.compress(text.getbuffer(), QUICK) if squeezed else text.getvalue(), squeezed)

    def open(self) -> T:
        """Return the value; its arrays have 64 bits again and are read-only."""
        value: T = pickle.loads(  # noqa: S301 - made by ``of``, in this program
            zlib.decompress(self.data) if self.squeezed else self.data
        )
        return value


class _Packer(pickle.Pickler):
    def reducer_override(self, value: object) -> Any:  # noqa: ANN401 - as pickle has it
        """Take arrays of floats; all else goes pickle's way."""
        if isinstance(value, np.ndarray) and value.dtype == np.float64 and value.ndim == 1:
            return _floats, (value.astype(np.float32).view(np.uint8).reshape(-1, 4).T.tobytes(),)
        return NotImplemented


def _floats(planes: bytes) -> FloatArray:
    """Return the numbers of which these are the first bytes, then the second ones, ..., (n,).

    So ordered, bytes that are alike stand together, and compression finds them.
    """
    rows = np.frombuffer(planes, dtype=np.uint8).reshape(4, -1)
    values = np.ascontiguousarray(rows.T).reshape(-1).view(np.float32).astype(np.float64)
    values.setflags(write=False)
    return values
