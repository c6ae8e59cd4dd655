"""Bytes to lines of text: UTF-8, UTF-16, or the code page that fits."""

from __future__ import annotations

import codecs
import io
import re
from collections.abc import Iterator
from typing import IO, TYPE_CHECKING

from connectors.exports.fault import RecordingError

if TYPE_CHECKING:
    from pathlib import Path

MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)
LOOKED_AT = 65536
"""Bytes from which the encoding is guessed."""
LONGEST_LINE = 1 << 24
"""Characters: ``MOST_COLUMNS`` have room for 800 each."""
PIECE = 1 << 20
"""Bytes that are decoded at a time."""
NO_TEXT = re.compile(r"[^\t\n\r\f\x1a -\U0010ffff]")
"""A control character that no text file has."""


def decoded(path: Path, file: IO[bytes]) -> Iterator[str]:
    """Yield the lines of a file, each with its end.

    UTF-8 and UTF-16 are known by their mark or by their bytes; other text is taken for the Windows code page
    1252, unless charset-normalizer finds a better one.

    Raises:
        RecordingError: The bytes are no text; before the first line.
    """
    encoding = _encoding(file)
    file.seek(0)
    length = _checked(path, file, encoding)
    file.seek(0)
    return _lines(path, file, encoding, length)


def _lines(path: Path, file: IO[bytes], encoding: str, length: int) -> Iterator[str]:
    """Yield the lines of the first ``length`` characters of a file."""
    with io.TextIOWrapper(file, encoding, newline="") as text:
        while length > 0 and (line := text.readline(LONGEST_LINE + 1)):
            if len(line) > LONGEST_LINE:
                fault = f"{path}: has a line of more than {LONGEST_LINE} characters, expected CSV"
                raise RecordingError(fault)
            yield line[:length]
            length -= len(line)


def _encoding(file: IO[bytes]) -> str:
    head = file.read(LOOKED_AT)
    for mark, encoding in MARKS:
        if head.startswith(mark):
            return encoding
    if head[1::2].count(0) > 0.4 * len(head[1::2]) > 0:
        return "utf-16-le"
    if head[::2].count(0) > 0.4 * len(head[::2]) > 0:
        return "utf-16-be"
    file.seek(0)
    try:
        for _ in _pieces(file, "utf-8"):
            pass
    except UnicodeDecodeError:
        return _code_page(head)
    return "utf-8"


def _checked(path: Path, file: IO[bytes], encoding: str) -> int:
    """Return the characters of the text, without what was allocated behind it and never filled."""
    length, ended, first = 0, False, True
    try:
        for piece in _pieces(file, encoding):
            text = piece.rstrip("\0")
            if (text and ended) or "\0" in text or (first and NO_TEXT.search(text, 0, LOOKED_AT)):
                raise RecordingError(f"{path}: expected CSV text, found a binary file")
            length, ended, first = length + len(text), ended or len(text) < len(piece), False
    except UnicodeDecodeError as error:
        raise RecordingError(
            f"{path}: expected CSV text in UTF-8, UTF-16 or code page 1252, found other bytes"
        ) from error
    return length


def _pieces(file: IO[bytes], encoding: str) -> Iterator[str]:
    decoder = codecs.getincrementaldecoder(encoding)()
    while content := file.read(PIECE):
        yield decoder.decode(content)
    yield decoder.decode(b"", final=True)


def _code_page(head: bytes) -> str:
    """Return the likeliest single-byte encoding; data are ASCII, so only names and units depend on it."""
    from charset_normalizer import from_bytes  # noqa: PLC0415 - only for files that are no UTF-8

    best = from_bytes(head, cp_isolation=["cp1252", "cp1250", "cp1251", "latin_1", "cp437", "cp850"]).best()
    return "cp1252" if best is None else best.encoding
