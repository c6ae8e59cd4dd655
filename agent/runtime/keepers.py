"""What an agent keeps beside its state: history, raw samples, and what sends both to a database."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from agent.runtime.samples.recorder import SampleRecorder
from agent.runtime.samples.sample_file import samples_path
from agent.runtime.store.history import History
from agent.runtime.store.history_file import history_path
from agent.runtime.supervisor import Health

if TYPE_CHECKING:
    from collections.abc import Coroutine

    from agent.runtime.store.forwarder import Forwarder
    from agent.settings import Settings

Work = Callable[[], "Coroutine[Any, Any, object]"]


@dataclass(frozen=True, slots=True)
class Keepers:
    """Each is None or absent where the settings do not want it."""

    history: History | None = None
    samples: SampleRecorder | None = None
    forwarders: tuple[Forwarder[Any], ...] = ()

    def tasks(self) -> Iterator[tuple[Health, Work]]:
        """Yield the tasks, for a supervisor."""
        if self.history is not None:
            yield Health("history"), self.history.run
        if self.samples is not None:
            yield Health("samples"), self.samples.run
        for each in self.forwarders:
            yield Health(f"database of {each.what}"), each.run


def keepers_of(settings: Settings, clock: Callable[[], float]) -> Keepers:
    """Make what the settings want; nothing is opened yet. ``clock`` returns the time, s UTC."""
    state, kept = settings.agent.state, settings.agent.history
    if state is None or kept is None:
        return Keepers()
    history = History(history_path(state), kept, clock)
    if kept.database is None:
        return Keepers(history)
    from agent.runtime.samples.postgres_samples import samples_forwarder  # noqa: PLC0415 - few have one
    from agent.runtime.store.postgres_history import history_forwarder  # noqa: PLC0415 - few have one

    forwarder = history_forwarder(history_path(state), kept.database)
    if kept.database.samples is None:
        return Keepers(history, forwarders=(forwarder,))
    samples = SampleRecorder(samples_path(state), kept.database.samples.max_mb)
    return Keepers(history, samples, (forwarder, samples_forwarder(samples_path(state), kept.database)))
