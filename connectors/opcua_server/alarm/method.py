"""What every method of the server does with its arguments and answers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from asyncua import ua


def status(code: int) -> ua.CallMethodResult:
    """Return an answer without values."""
    return ua.CallMethodResult(StatusCode=ua.StatusCode(code))


def values_of(
    arguments: Sequence[ua.Variant], kinds: Sequence[ua.VariantType]
) -> tuple[list[Any], ua.CallMethodResult | None]:
    """Return the values of a method's arguments, and where they are not as expected, the answer to give.

    A null text is taken for an empty one, as some clients send it where nobody wrote a comment.
    """
    if len(arguments) < len(kinds):
        return [], status(ua.StatusCodes.BadArgumentsMissing)
    if len(arguments) > len(kinds):
        return [], status(ua.StatusCodes.BadTooManyArguments)
    wrong = [
        a.VariantType is not kind and not (a.Value is None and kind is ua.VariantType.LocalizedText)
        for a, kind in zip(arguments, kinds, strict=True)
    ]
    if any(wrong):
        result = status(ua.StatusCodes.BadInvalidArgument)
        codes = [ua.StatusCodes.BadTypeMismatch if bad else ua.StatusCodes.Good for bad in wrong]
        result.InputArgumentResults = [ua.StatusCode(code) for code in codes]
        return [], result
    return [a.Value for a in arguments], None
