"""What a person says of a valve in place of the verdict: kept, signed and shown until it is withdrawn."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal

from pydantic import BaseModel, Field

if TYPE_CHECKING:
    from agent.report.ranking import Group
    from agent.runtime.store.history_file import Entry

Judged = Literal["sticks", "sound", "withdrawn"]
KEY = "judgement"
"""Of a note in the history."""
GROUP_OF: Mapping[Judged, Group] = {"sticks": "sticks", "sound": "healthy"}


class PersonalJudgement(BaseModel):
    """One judgement as it is sent."""

    judgement: Judged
    by: Annotated[str, Field(min_length=1, max_length=80)]
    """Who says so."""
    comment: Annotated[str, Field(min_length=1, max_length=1000)]
    """Why; a judgement without a reason is worth nothing a month later."""


@dataclass(frozen=True, slots=True)
class Judgement:
    """One judgement as it is kept."""

    judgement: Judged
    by: str
    comment: str
    time: float
    """s UTC."""

    @property
    def group(self) -> Group:
        """Return the group in which the work list has the loop."""
        return GROUP_OF[self.judgement]


def standing(entries: Iterable[Entry]) -> dict[str, Judgement]:
    """Return the judgement that stands of each loop, from notes of the history, the oldest first."""
    found: dict[str, Judgement] = {}
    for entry in entries:
        content = entry.content
        said = content.get(KEY)
        judged: Judged | None = next((each for each in GROUP_OF if each == said), None)
        if judged is not None:
            found[entry.loop] = Judgement(judged, content["by"], content["comment"], entry.time)
        elif said == "withdrawn":
            found.pop(entry.loop, None)
    return found
