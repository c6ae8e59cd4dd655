"""MAT-files as MATLAB and Octave write them."""

import io
import struct

import numpy as np
from scipy.io import savemat

from tests.exports.truth import LOOPS, TIME, TS


def saved(held, *, packed=True):
    file = io.BytesIO()
    savemat(file, held, do_compression=packed)
    return file.getvalue()


def vectors():
    """Column vectors and a sampling time, as a workspace is saved."""
    loop = LOOPS[0]
    return saved(
        {"OP": loop.op[:, None], "PV": loop.pv[:, None], "Ts": TS, "Comments": "level"}, packed=False
    )


def with_times():
    loop = LOOPS[0]
    return saved({"time": TIME, "op": loop.op, "pv": loop.pv_with_gaps, "other": np.arange(3.0)})


def structures():
    """A structure a loop within one of a plant, the sampling time once for all."""
    plant = {loop.name: {"OP": loop.op, "PV": loop.pv, "SP": loop.sp} for loop in LOOPS}
    return saved({"plant": {"unit1": plant, "Ts": TS}})


def deep(levels):
    """Structures within each other, more than a process has stack for."""

    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)

    def matrix(kind, name, body):
        head = element(6, struct.pack("<II", kind, 0)) + element(5, struct.pack("<ii", 1, 1))
        return element(14, head + element(1, name) + body)

    inner = matrix(6, b"", element(9, struct.pack("<d", 1.0)))
    for level in range(levels):
        fields = element(5, struct.pack("<i", 8)) + element(1, b"a".ljust(8, b"\0"))
        inner = matrix(2, b"top" if level == levels - 1 else b"", fields + inner)
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x100) + b"IM" + inner
