"""Bytes to text: UTF-8, UTF-16, or the code page that fits."""

from __future__ import annotations

import codecs
import re
from typing import TYPE_CHECKING

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
NO_TEXT = re.compile(r"[^\t\n\r\f\x1a -\U0010ffff]")
"""A control character that no text file has."""


def decoded(path: Path, content: bytes) -> str:
    """Return the text of a file.

    UTF-8 and UTF-16 are known by their mark or by their bytes; other text is taken for the Windows code page
    1252, unless charset-normalizer finds a better one.

    Raises:
        RecordingError: The bytes are no text.
    """
    text = _text(path, content).rstrip("\0")  # a file that was allocated and never filled
    if NO_TEXT.search(text, 0, LOOKED_AT) or "\0" in text:
        raise RecordingError(f"{path}: expected CSV text, found a binary file")
    return text


def _text(path: Path, content: bytes) -> str:
    for mark, encoding in MARKS:
        if content.startswith(mark):
            return _decode(path, content, encoding)
    head = content[:LOOKED_AT]
    if head[1::2].count(0) > 0.4 * len(head[1::2]) > 0:
        return _decode(path, content, "utf-16-le")
    if head[::2].count(0) > 0.4 * len(head[::2]) > 0:
        return _decode(path, content, "utf-16-be")
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return _decode(path, content, _code_page(head))


def _code_page(head: bytes) -> str:
    """Return the likeliest single-byte encoding; data are ASCII, so only names and units depend on it."""
    from charset_normalizer import from_bytes  # noqa: PLC0415 - only for files that are no UTF-8

    best = from_bytes(head, cp_isolation=["cp1252", "cp1250", "cp1251", "latin_1", "cp437", "cp850"]).best()
    return "cp1252" if best is None else best.encoding


def _decode(path: Path, content: bytes, encoding: str) -> str:
    try:
        return content.decode(encoding)
    except UnicodeDecodeError as error:
        raise RecordingError(
            f"{path}: expected CSV text in UTF-8, UTF-16 or code page 1252, found other bytes"
        ) from error
