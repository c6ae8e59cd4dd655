"""Damaged exports: each is refused in one line, or what is read has the times that the file states."""

import numpy as np
import pytest

from connectors.exports.fault import RecordingError
from connectors.exports.reading import read_export
from tests.exports.corpus import CASES
from tests.exports.truth import TIME

PACKED = (".gz", ".zip", ".xlsx", ".parquet", ".mat")
TEXTS = [
    case
    for case in CASES
    if not (case.settles or case.options or case.name.endswith(PACKED) or case.name == "utf16.csv")
]
JUNK = (b"", b"??", b"#REF!", b"1e999", b"-", b"\xff\xfe", b"12:00", b"0x1F", b'"', b"None", b"1,2", b"\x00")


def read(path, content):
    """Return the loops of a file; a refusal is one line and gives none."""
    path.write_bytes(content)
    try:
        return read_export(path).loops
    except RecordingError as error:
        refused = str(error)
    assert "\n" not in refused
    return ()


def lines_lost(rows, rng):
    return [row for row in rows if rng.random() > 0.03]


def lines_repeated(rows, rng):
    return [row for row in rows for _ in range(2 if rng.random() < 0.03 else 1)]


def cells_lost(rows, rng):
    return [row.rsplit(b",", 1)[0] if rng.random() < 0.03 else row for row in rows]


def cells_of_junk(rows, rng):
    """Put junk in place of the last cell of some rows, never of a time."""
    junk = JUNK[rng.integers(len(JUNK))]
    return [row[: row.rfind(b",") + 1] + junk if rng.random() < 0.03 and b"," in row else row for row in rows]


def lines_of_junk(rows, rng):
    junk = JUNK[rng.integers(len(JUNK))]
    return [each for row in rows for each in ((row, junk) if rng.random() < 0.03 else (row,))]


def cut_short(rows, rng):
    return rows[: rng.integers(3, len(rows))]


DAMAGES = (lines_lost, lines_repeated, cells_lost, cells_of_junk, lines_of_junk, cut_short)


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
def test_no_damage_makes_a_wrong_time(damage, tmp_path):
    rng = np.random.default_rng(24)
    readable = 0
    for case in TEXTS:
        head, *rows = case.content.split(b"\n")
        content = b"\n".join([head, *damage(rows, rng)])
        for loop in read(tmp_path / case.name, content):
            true = TIME if case.time is None else case.time
            nearest = np.abs(loop.time[:, None] - true[None, :]).min(axis=1)
            assert nearest.max() < 2e-3, case.name
            readable += 1
    assert readable > len(TEXTS) / 2


@pytest.mark.parametrize("seed", range(4))
def test_no_byte_is_a_crash(seed, tmp_path):
    rng = np.random.default_rng(seed)
    for case in CASES:
        content = bytearray(case.content)
        for place in rng.integers(0, len(content), 1 + seed * 5):
            content[place] = rng.integers(256)
        read(tmp_path / case.name, bytes(content[: rng.integers(1, len(content))] if seed == 3 else content))
