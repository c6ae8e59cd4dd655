"""What a message says of the worth of its value: words, flags, codes of OPC Classic and OPC UA."""

from __future__ import annotations

from collections.abc import Collection

from connectors.base import Quality
from connectors.exports.cells.quality_words import OPC_GOOD, OPC_UNCERTAIN, code_of, quality_of_word
from connectors.mqtt.messages.malformed import JsonTree
from connectors.mqtt.messages.payload import text_of

UA_FROM = 1024
"""OPC Classic has codes below 256 and Ignition below this; from here they are status codes of OPC UA."""
UA_WORTH_AT = 30
"""Place of the two bits of a status code of OPC UA that say what a value is worth (OPC UA Part 4, 7.39)."""


def quality(said: JsonTree, good: Collection[str] = ()) -> Quality:
    """Return what a quality says, good where there is none: OPC UA and Ignition leave a good one out.

    0 is good in OPC UA and bad in OPC Classic, and 1 is nothing in either: both are bad unless ``good`` has
    them.

    Args:
        said: A word, a flag, a number, or the ``StatusCode`` of OPC UA with its ``Code`` or ``Symbol``.
        good: Texts of the qualities that are good, and no others; empty: as above.
    """
    if isinstance(said, dict):
        said = said.get("Code", said.get("Symbol"))
    if said is None:
        return Quality.GOOD
    if good:
        return Quality.GOOD if text_of(said) in good else Quality.BAD
    if isinstance(said, bool):
        return Quality.GOOD if said else Quality.BAD
    code = code_of(said.strip().casefold()) if isinstance(said, str) else said
    if isinstance(code, int | float):
        return _of_code(code)
    return quality_of_word(said) if isinstance(said, str) else Quality.BAD


def _of_code(code: float) -> Quality:
    if UA_FROM <= code < 2**32:
        return (Quality.GOOD, Quality.UNCERTAIN, Quality.BAD, Quality.BAD)[int(code) >> UA_WORTH_AT]
    if OPC_GOOD <= code < 256:
        return Quality.GOOD
    return Quality.UNCERTAIN if OPC_UNCERTAIN <= code < 128 else Quality.BAD
