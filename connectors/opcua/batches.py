"""Requests about many nodes, parted as the server takes them: plants' servers refuse too many at once."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Sequence
from typing import TypeVar

from asyncua import ua

from connectors.cancellation import obey_cancellation

MOST = 500
"""Nodes in the first request. Servers allow from 10 or so to some thousands (OPC UA Part 5, 6.3.11)."""
_TOO_MANY = (
    ua.StatusCodes.BadTooManyOperations,
    ua.StatusCodes.BadEncodingLimitsExceeded,
    ua.StatusCodes.BadRequestTooLarge,
    ua.StatusCodes.BadResponseTooLarge,
)
ItemT = TypeVar("ItemT")
AnswerT = TypeVar("AnswerT")


class Batches:
    """Remembers how many a server takes."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most

    async def ask(
        self, request: Callable[[list[ItemT]], Awaitable[Sequence[AnswerT]]], items: Sequence[ItemT]
    ) -> list[AnswerT]:
        """Return the answers to all ``items``, an answer each; raises what the server says but "too many"."""
        answers: list[AnswerT] = []
        while len(answers) < len(items):
            batch = list(items[len(answers) : len(answers) + self._most])
            try:
                got = await request(batch)
            except ua.UaError as error:
                if getattr(error, "code", None) not in _TOO_MANY or len(batch) == 1:
                    raise
                self._most = len(batch) // 2
                continue
            obey_cancellation()
            if len(got) != len(batch):
                raise ua.UaError(f"the server gave {len(got)} answers to {len(batch)} questions")
            answers += got
        return answers
