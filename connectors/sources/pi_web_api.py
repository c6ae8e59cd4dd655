"""AVEVA PI Web API: recorded values of PI points, all tags of a loop in one batch, paged by time.

After the PI Web API reference: ``dataservers``, ``dataservers/{webId}/points``, ``points?path=``,
``streams/{webId}/recorded`` and ``batch``. Recorded values are those that the archive kept: they are
compressed unless the point is configured otherwise.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

from connectors.base import ConfigError
from connectors.exports.fault import RecordingError
from connectors.sources.address import parted
from connectors.sources.collected import CollectedTag, Overlap
from connectors.sources.json_client import JsonClient
from connectors.sources.tag_source import TagSource

if TYPE_CHECKING:
    from connectors.exports.recorded import ReadOptions

POINTS = 1000
"""Of one page of the list of points."""
VALUES = 10_000
"""Of one page of a stream; servers refuse more than 150,000 unless configured otherwise."""
FIELDS = "Items.Timestamp;Items.Value;Items.Good"


class PiWebApi(TagSource):
    """``pi+https://HOST/piwebapi?server=PISRV&filter=FIC*``: the points of one data server."""

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is connected yet."""
        super().__init__(name, options)
        self._address = parted(name, {"server", "filter"})
        self._client = JsonClient(self._address)
        self._server: tuple[str, str] | None = None
        self._points: dict[str, str] = {}
        """Tag -> WebId."""

    def close(self) -> None:
        """Close the connection."""
        self._client.close()

    def tags(self) -> Iterator[str]:
        """Yield the names of the points."""
        server, _ = self._data_server()
        parameters: dict[str, str | int] = {
            "nameFilter": self._address.parameters.get("filter", "*"),
            "maxCount": POINTS,
            "selectedFields": "Items.WebId;Items.Name",
        }
        while True:
            page: dict[str, str | int] = {"startIndex": len(self._points), **parameters}
            items = self._client.get(f"dataservers/{server}/points", page)["Items"]
            new = {each["Name"]: each["WebId"] for each in items if each["Name"] not in self._points}
            self._points |= new
            yield from new
            if len(items) < POINTS or not new:
                return

    def collect(self, wanted: Mapping[str, CollectedTag]) -> None:
        """Read the values of some points."""
        ids = {tag: self._web_id(tag) for tag in wanted}
        pages = {tag: Overlap(VALUES) for tag in wanted}
        while pages:
            answer = self._client.post(
                "batch", {tag: self._request(ids[tag], pages[tag].last) for tag in pages}
            )
            for tag in list(pages):
                stamps = self._take(tag, answer.get(tag), pages[tag], wanted[tag])
                if not pages[tag].is_full(stamps):
                    del pages[tag]

    def _request(self, web_id: str, last: object) -> dict[str, str]:
        start = _written(self.start) if last is None else str(last)
        parameters = {
            "startTime": start,
            "endTime": _written(self.end),
            "boundaryType": "Inside",
            "maxCount": VALUES,
            "selectedFields": FIELDS,
        }
        return {
            "Method": "GET",
            "Resource": f"{self._address.base()}/streams/{web_id}/recorded?{urlencode(parameters)}",
        }

    def _take(self, tag: str, answer: Any, page: Overlap, into: CollectedTag) -> list[str]:  # noqa: ANN401 - JSON
        """Take the new values of one page; return the times of all of them."""
        status = None if answer is None else answer.get("Status")
        if status != 200:
            content = "" if answer is None else answer.get("Content")
            words = " ".join(str(content).split())[:200]
            raise RecordingError(f"{self.name}: tag {tag}: HTTP {status}: {words}")
        items = answer["Content"]["Items"]
        stamps = [each["Timestamp"] for each in items]
        new = page.new(stamps)
        if new is None:
            raise RecordingError(f"{self.name}: tag {tag}: more than {VALUES} values at {page.last}")
        for each in (items[k] for k in new):
            time = _read(each["Timestamp"])
            if time < self.end:
                into.add(
                    time, _plain(each.get("Value")), good=each.get("Good", True) and "Errors" not in each
                )
        return stamps

    def _web_id(self, tag: str) -> str:
        if tag not in self._points:
            _, server = self._data_server()
            path = f"\\\\{server}\\{tag}"
            try:
                found = self._client.get("points", {"path": path, "selectedFields": "WebId"})
            except ConfigError as error:
                raise RecordingError(f"{self.name}: tag {tag}: {error.faults[0]}") from error
            self._points[tag] = found["WebId"]
        return self._points[tag]

    def _data_server(self) -> tuple[str, str]:
        """Return WebId and name of the data server."""
        if self._server is None:
            wanted = self._address.parameters.get("server")
            items = self._client.get("dataservers", {"selectedFields": "Items.WebId;Items.Name"})["Items"]
            found = [each for each in items if wanted in {None, each["Name"]}]
            if len(found) != 1:
                names = ", ".join(each["Name"] for each in items) or "none"
                raise RecordingError(f"{self.name}: expected one data server by server=NAME, it has: {names}")
            self._server = found[0]["WebId"], found[0]["Name"]
        return self._server


def _plain(value: object) -> object:
    """Return a value; of a digital state its name, and None for those that stand for no value."""
    if isinstance(value, dict):
        return None if value.get("IsSystem") else value.get("Name")
    return value


def _written(time: float) -> str:
    return datetime.fromtimestamp(time, UTC).isoformat().replace("+00:00", "Z")


def _read(stamp: str) -> float:
    time = datetime.fromisoformat(stamp)
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()
