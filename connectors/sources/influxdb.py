"""InfluxDB 1.x over HTTP (``/query``, InfluxQL), paged by time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from connectors.exports.fault import RecordingError
from connectors.sources.address import parted
from connectors.sources.collected import CollectedTag, Overlap
from connectors.sources.json_client import JsonClient
from connectors.sources.tag_source import TagSource

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions

VALUES = 10_000
"""Of one page: InfluxDB's own chunk."""
VALUE = "value"
"""Name of the field where a series has one."""


class InfluxDb(TagSource):
    """``influxdb+http://HOST:8086/DATABASE``: each field of each measurement is a tag.

    ``?measurement=M&tag=KEY&field=value`` instead: one measurement, in which the tag KEY names the tags.
    """

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is connected yet."""
        super().__init__(name, options)
        address = parted(name, {"measurement", "tag", "field", "policy"})
        database = address.path.strip("/").rpartition("/")
        if not database[2]:
            raise RecordingError(f"{name}: expected a database, as in influxdb+http://host:8086/plant")
        of = address.parameters
        if ("measurement" in of) != ("tag" in of):
            raise RecordingError(f"{name}: measurement and tag belong together")
        self._database, self._policy = database[2], of.get("policy")
        self._key = (of["measurement"], of["tag"], of.get("field", VALUE)) if "tag" in of else None
        self._client = JsonClient(replace(address, path=f"/{database[0]}"))

    def close(self) -> None:
        """Close the connection."""
        self._client.close()

    def tags(self) -> Iterator[str]:
        """Yield values of the tag KEY, or measurement and field joined by a dot."""
        if self._key is not None:
            measurement, key, _ = self._key
            statement = f"SHOW TAG VALUES FROM {_quoted(measurement)} WITH KEY = {_quoted(key)}"
            for series in self._series(statement):
                yield from (row[1] for row in series["values"])
            return
        for series in self._series("SHOW FIELD KEYS"):
            for row in series["values"]:
                yield series["name"] if row[0] == VALUE else f"{series['name']}.{row[0]}"

    def collect(self, wanted: Mapping[str, CollectedTag]) -> None:
        """Read the values of some tags."""
        for tag, into in wanted.items():
            page = Overlap(VALUES)
            while True:
                rows = self._page(tag, page.last)
                stamps = [row[0] for row in rows]
                new = page.new(stamps)
                if new is None:
                    raise RecordingError(
                        f"{self.name}: tag {tag}: more than {VALUES} values at {page.last} ns"
                    )
                for k in new:
                    into.add(rows[k][0] / 1e9, rows[k][1])
                if not page.is_full(stamps):
                    break

    def _page(self, tag: str, last: object) -> list[list[Any]]:
        start = round(self.start * 1e9) if last is None else last
        if self._key is None:
            measurement, _, field = tag.rpartition(".") if "." in tag else (tag, "", VALUE)
            where = ""
        else:
            (measurement, key, field) = self._key
            where = f"{_quoted(key)} = {_text(tag)} AND "
        policy = "" if self._policy is None else f"{_quoted(self._policy)}."
        statement = (
            f"SELECT {_quoted(field)} FROM {policy}{_quoted(measurement)} WHERE {where}"  # noqa: S608 - quoted
            f"time >= {start} AND time < {round(self.end * 1e9)} ORDER BY time LIMIT {VALUES}"
        )
        rows = [row for series in self._series(statement, f"tag {tag}: ") for row in series["values"]]
        return sorted(rows, key=lambda row: row[0])

    def _series(self, statement: str, what: str = "") -> list[dict[str, Any]]:
        """Return the series of one statement; raises RecordingError with what the server says."""
        answer = self._client.get("query", {"db": self._database, "q": statement, "epoch": "ns"})
        result = answer.get("results", [{}])[0]
        fault = answer.get("error") or result.get("error")
        if fault:
            raise RecordingError(f"{self.name}: {what}{fault} (in: {statement})")
        series: list[dict[str, Any]] = result.get("series", [])
        return series


def _quoted(identifier: str) -> str:
    return '"' + identifier.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _text(value: str) -> str:
    return "'" + value.replace("\\", "\\\\").replace("'", "\\'") + "'"
