"""A server that answers the four statements of InfluxQL that are sent, as InfluxDB 1.x does."""

import re

from tests.contracts.sources_served.history import held
from tests.contracts.sources_served.http_server import Answers

SELECT = re.compile(
    r'SELECT "value" FROM "samples" WHERE "tag" = \'(?P<tag>[^\']+)\' AND '
    r"time >= (?P<start>\d+) AND time < (?P<end>\d+) ORDER BY time LIMIT (?P<most>\d+)"
)


class InfluxServer(Answers):
    """Database `plant` with a measurement `samples` whose tag `tag` names the tags."""

    def __init__(self):
        super().__init__()
        self.points = held()
        self.stuck = False

    def answer(self, method, path, query, _body):
        asked = dict(query)
        assert (method, path, asked["epoch"]) == ("GET", "/query", "ns")
        if asked["db"] != "plant":
            return 200, {"results": [{"statement_id": 0, "error": f"database not found: {asked['db']}"}]}
        return 200, {"results": [{"statement_id": 0, **self._result(asked["q"])}]}

    def _result(self, statement):
        if statement.startswith("SHOW TAG VALUES"):
            assert statement == 'SHOW TAG VALUES FROM "samples" WITH KEY = "tag"'
            rows = [["tag", name] for name in self.points]
            return {"series": [{"name": "samples", "columns": ["key", "value"], "values": rows}]}
        found = SELECT.fullmatch(statement)
        if found is None:
            return {"error": f"error parsing query: {statement}"}
        if found["tag"] == "TIC9.OP" and getattr(self, "broken", False):
            return {"error": "shard is disabled"}
        rows = [
            [round(each.time * 1e9), None if isinstance(each.value, str) or not each.good else each.value]
            for each in self.points[found["tag"]]
        ]
        rows = [row for row in rows if int(found["start"]) <= row[0] < int(found["end"])]
        if self.stuck:
            rows = [rows[0]] * (int(found["most"]) + 1)
        if not rows:
            return {}
        rows = rows[: int(found["most"])]
        return {"series": [{"name": "samples", "columns": ["time", "value"], "values": rows}]}
