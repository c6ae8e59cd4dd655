"""Finds the loops of an MQTT broker by what is published there."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from agent.runtime.commission.found_loops import LoopSearch, Patterns, found_loops, groups_of
from agent.runtime.commission.heard_tags import heard_tags
from agent.settings.tag_names import NamedTag
from connectors.mqtt.heard import hear
from connectors.mqtt.options import MqttOptions


async def find_published_loops(
    options: MqttOptions,
    topics: str,
    seconds: float,
    most_topics: int,
    patterns: Patterns | None = None,
    progress: Callable[[int, int], None] = lambda _seen, _waiting: None,
) -> LoopSearch:
    """Hear what a broker's clients publish and find the loops in it; raises ConnectionLostError.

    Args:
        options: The broker.
        topics: Filter with wildcards.
        seconds: How long.
        most_topics: Topics after which it ends.
        patterns: Of the names.
        progress: Called now and then with all s and those that are left.
    """
    length = round(seconds)
    heard = await hear(
        options, topics, seconds, most_topics, lambda past: progress(length, length - round(past))
    )

    def loops_of(names: Iterable[str]) -> int:
        return len(groups_of([NamedTag(each, (each,)) for each in names], patterns))

    tags = [
        tag
        for topic, payloads in sorted(heard.messages.items())  # which came first is chance
        for tag in heard_tags(topic, payloads, loops_of)
    ]
    places = {str(place): tag for place, tag in enumerate(tags)}
    groups = groups_of([NamedTag(place, (tag.name,)) for place, tag in places.items()], patterns)
    entries = {place: tag.tag for place, tag in places.items()}
    loops = found_loops(groups, entries, {place: tag.value for place, tag in places.items()}, {})
    return LoopSearch(loops, len(heard.messages), len(tags), heard.stopped, ("topics", "values"))
