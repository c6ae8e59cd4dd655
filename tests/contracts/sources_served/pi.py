"""A server that follows the documented PI Web API: data servers, points, recorded values, batch.

Written after the reference (docs.aveva.com, PI Web API Reference: DataServer GetPoints, Point GetByPath,
Stream GetRecorded, Batch Execute); no PI server was at hand. It says what the reference says of `maxCount`,
of boundary type Inside (both ends count), of digital states and of a batch (207, a dictionary of answers).
"""

from datetime import UTC, datetime
from urllib.parse import parse_qsl, urlsplit

from tests.contracts.sources_served.history import held
from tests.contracts.sources_served.http_server import Answers

SERVER = {"WebId": "F1DS-server", "Name": "PISRV"}
NO_DATA = {"Name": "No Data", "Value": 248, "IsSystem": True}


def stamp(time):
    """Return a time with the seven digits of PI."""
    return f"{datetime.fromtimestamp(time, UTC):%Y-%m-%dT%H:%M:%S.%f}0Z"


class PiServer(Answers):
    """One data server with points."""

    def __init__(self, most=None):
        super().__init__()
        self.points = held()
        self.most = most
        """Largest `maxCount` that the server is configured for."""
        self.stuck = False
        """Whether a whole page has one time."""

    def answer(self, method, path, query, body):
        if (method, path) == ("POST", "/piwebapi/batch"):
            return 207, {key: self._part(each) for key, each in body.items()}
        status, content = self._get(path, dict(query))
        return status, content

    def _part(self, request):
        assert request["Method"] == "GET"
        parts = urlsplit(request["Resource"])  # whatever host it names, this server answers
        status, content = self._get(parts.path, dict(parse_qsl(parts.query)))
        return {"Status": status, "Headers": {}, "Content": content}

    def _get(self, path, query):
        words = path.removeprefix("/piwebapi/").split("/")
        match words:
            case ["dataservers"]:
                return 200, {"Links": {}, "Items": [SERVER]}
            case ["dataservers", "F1DS-server", "points"]:
                start, most = int(query["startIndex"]), int(query["maxCount"])
                wanted = query["nameFilter"].rstrip("*")
                names = [name for name in self.points if name.startswith(wanted)]
                return 200, {"Items": [self._point(name) for name in names[start : start + most]]}
            case ["points"]:
                name = query["path"].rsplit("\\", 1)[1]
                if name not in self.points:
                    return 404, {"Errors": [f"PI Point not found '{name}'."]}
                return 200, self._point(name)
            case ["streams", web_id, "recorded"]:
                return self._recorded(web_id.removeprefix("P-"), query)
        return 404, {"Message": f"no resource {path}"}

    def _point(self, name):
        return {"WebId": f"P-{name}", "Name": name}

    def _recorded(self, name, query):
        most = int(query["maxCount"])
        if self.most is not None and most > self.most:
            return 400, {"Errors": [f"maxCount is greater than the maximum allowed {self.most}"]}
        if name == "TIC9.OP" and getattr(self, "broken", False):
            return 502, {"Errors": ["[-11059] No Good Data For Calculation"]}
        start, end = query["startTime"], query["endTime"]
        found = [each for each in self.points[name] if _time(start) <= each.time <= _time(end)]
        if self.stuck:
            found = [found[0]] * (most + 1)
        return 200, {"Items": [_item(each) for each in found[:most]]}


def _time(text):
    return datetime.fromisoformat(text).timestamp()


def _item(each):
    value = NO_DATA if isinstance(each.value, str) else each.value
    return {"Timestamp": stamp(each.time), "Value": value, "Good": each.good and value is not NO_DATA}
