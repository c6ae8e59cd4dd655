"""Sessions of the workbench over REST: what is refused, what is bounded, what goes with its session."""

import asyncio
import io
import time

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from agent.physics.effects import EFFECTS
from agent.web.access import Access
from agent.web.app import application
from agent.web.screens import workbench
from agent.web.workbench import sessions as module
from agent.web.workbench.desk import Desk, Opening
from agent.web.workbench.sessions import MOST, Sessions, WorkbenchError
from agent.workbench.session import bench
from tests.unit.web.clients import client, csrf

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]  # a cold cache of kernels takes a minute
EVIL = "<script>alert(1)<script>.csv"


def recording(samples=300):
    """A first-order lag behind a dead band, as CSV."""
    rng = np.random.default_rng(1)
    op = 50 + 6 * np.repeat(rng.uniform(-1, 1, samples // 20), 20) + np.linspace(0, 1, samples)
    stem, pv, lines = 50.0, 30.0, ["time,OP,PV"]
    for second, value in enumerate(op):
        stem = np.clip(stem, value - 1.5, value + 1.5)
        pv += 0.1 * (stem - 20 - pv)
        lines.append(f"{second},{value:.4f},{pv + 0.05 * rng.standard_normal():.4f}")
    return "\n".join(lines).encode()


@pytest.fixture
async def served():
    """A client of the workbench, and its sessions."""
    sessions = Sessions()
    app = application([workbench.screen(sessions, path="/")], Access())
    async with client(app, timeout=200) as web:
        web.headers.update(await csrf(web))
        yield web, sessions
    opening = [each.opening for each in sessions.open.values() if each.opening is not None]
    for name in [*sessions.open]:
        sessions.end(name)
    await asyncio.gather(*opening, return_exceptions=True)


async def until(condition, patience=200.0):
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end
        await asyncio.sleep(0.02)


async def test_a_session_from_the_upload_to_its_end(served):
    web, sessions = served
    answer = await web.post("/api/workbench/sessions", params={"name": EVIL}, content=recording())
    assert answer.status_code == 200, answer.text
    name = answer.json()["session"]
    base = f"/api/workbench/sessions/{name}"
    state = (await web.get(base)).json()
    assert (state["recording"], state["samples"], state["columns"]["OP"]) == (EVIL, 300, "OP")
    assert [each["name"] for each in state["nodes"]] == ["fopdt"]
    assert len(state["model"]["curves"]["pv"]) == 300
    folder = sessions.open[name].folder
    assert [path.name for path in folder.rglob("*.csv")] == [
        "_script_alert_1__script_.csv"
    ]  # no other letters on disk
    simulated = await web.post(f"{base}/simulate", json={"values": {"tau": 3.0}})  # waits for the candidates
    assert len(simulated.json()["pv"]) == 300
    found = (await web.get(base)).json()["found"]
    assert found["candidates"]
    tried = {each["effect"] for each in found["candidates"]}
    assert found["not_fitted"]
    reasons = {each["effect"]: each["why"] for each in found["not_shown"]}
    assert all(reasons.values())
    assert not set(found["not_fitted"]) & (tried | reasons.keys())
    assert found["verdict"]["words"]
    panel = (await web.get(f"{base}/axis/op_level")).json()
    assert len(panel["edges"]) == len(panel["means"]) + 1
    for path, body, words in (
        ("simulate", {"values": {"nonsense": 1.0}}, "no parameter nonsense"),
        ("tick", {"effect": "nonsense"}, "no effect 'nonsense'"),
        ("go", {"number": 7}, "no step 7"),
        ("leave-out", {"start": 0.0, "end": 1e9}, "not testable"),
        ("columns", {"columns": {"PV": "flow"}}, "flow"),
        ("columns", {"columns": {"ts": "nan"}}, "the sampling time is nan, expected seconds above 0"),
    ):
        refused = await web.post(f"{base}/{path}", json=body)
        assert (refused.status_code, words in refused.json()["detail"]) == (422, True), refused.text
    assert (await web.get(f"{base}/axis/nowhere")).status_code == 422
    assert (await web.delete(base)).status_code == 204
    assert (await web.get(base)).status_code == 404
    await until(lambda: not folder.exists())


def a_bomb():
    """A Parquet file of little size that unpacks to much: one value, repeated without end."""
    content = io.BytesIO()
    column = pa.DictionaryArray.from_arrays(pa.array(np.zeros(30_000_000, np.int8)), pa.array(["1"]))
    pq.write_table(pa.table({"time": column, "OP": column, "PV": column}), content)
    return content.getvalue()


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("columns.csv", lambda: b"time,a,b\n1,2,3\n2,3,4\n", "columns.csv"),
        ("binary.csv", lambda: bytes(range(256)) * 40, "binary.csv"),
        ("header.csv", lambda: b"time,OP,PV\nhere,lies,the header\n", "header.csv"),
        pytest.param("bomb.parquet", a_bomb, "bomb.parquet", marks=pytest.mark.bench),
    ],
)
async def test_a_bad_upload_gets_one_clear_line_and_leaves_no_session(served, name, content, words):
    web, sessions = served
    answer = await web.post("/api/workbench/sessions", params={"name": name}, content=content())
    detail = answer.json()["detail"]
    assert (answer.status_code, words in detail, "\n" in detail) == (422, True, False), detail
    assert "slipjump-workbench-" not in detail
    assert not sessions.open


async def test_columns_that_nobody_recognises_are_chosen_from_the_file(served):
    web, _ = served
    other = recording().replace(b"time,OP,PV", b"t,u <b>,y")
    answer = await web.post("/api/workbench/sessions", params={"name": "x.csv"}, content=other)
    assert (answer.status_code, answer.json()["columns"]) == (422, ["t", "u <b>", "y"])
    chosen = {"name": "x.csv", "time": "t", "op": "u <b>", "pv": "y"}
    answer = await web.post("/api/workbench/sessions", params=chosen, content=other)
    assert answer.status_code == 200, answer.text
    base = f"/api/workbench/sessions/{answer.json()['session']}"
    assert (await web.get(base)).json()["columns"]["OP"] == "u <b>"
    assert (await web.get(f"{base}/columns")).json() == ["t", "u <b>", "y"]


async def test_a_body_that_is_too_large_is_refused_before_it_is_read(served):
    web, _ = served
    huge = {"Content-Length": str(workbench.LARGEST + 1)}
    answer = await web.post("/api/workbench/sessions", params={"name": "x.csv"}, content=b"", headers=huge)
    assert answer.status_code == 413


class Silent:
    """A session without a process."""

    def __init__(self, name, folder, clock):
        self.name, self.folder, self.used, self.pages, self.ended = name, folder, clock(), set(), False

    def end(self):
        self.ended = True


async def test_sessions_are_bounded_and_idle_ones_end(monkeypatch):
    monkeypatch.setattr(module, "WorkbenchSession", Silent)
    now = [0.0]
    sessions = Sessions(lambda: now[0])
    made = []
    for number in range(MOST):
        now[0] = float(number)
        made.append(sessions.create())
    sessions.create()
    assert [each.ended for each in made] == [True, False, False, False]  # the one unused for longest
    for each in sessions.open.values():
        each.pages.add("a page")
    with pytest.raises(WorkbenchError, match="4 sessions are open"):
        sessions.create()
    for each in sessions.open.values():
        each.pages.clear()
    now[0] += module.IDLE + 1
    sessions.end_idle()
    assert not sessions.open


async def test_a_session_whose_process_dies_says_so(served):
    web, sessions = served
    session = sessions.create()
    session._process.kill()
    with pytest.raises(WorkbenchError, match="has ended"):
        await session.command("open", Opening(session.folder / "none.csv", "none.csv"))
    assert (await web.get("/api/workbench/sessions")).json()["sessions"] == []  # nobody can go on with it
    answer = await web.post(f"/api/workbench/sessions/{session.name}/go", json={"number": 0})
    assert answer.status_code == 422


def test_the_first_curve_of_a_tick_comes_before_its_fit(tmp_path, monkeypatch):
    few = [each for each in EFFECTS if each.name in {"deadband", "sensor_lag"}]
    monkeypatch.setattr(bench, "known_effects", lambda: few)
    sent = []
    desk = Desk(lambda kind, content: sent.append((kind, content)))
    (tmp_path / "a.csv").write_bytes(recording(400).replace(b"time,OP,PV", b"time,u,y"))
    desk.open(Opening(tmp_path / "a.csv", "a.csv", columns={"OP": "u", "PV": "y", "SP": ""}), map)
    sent.clear()
    desk.tick("deadband")
    kinds = [kind for kind, _ in sent]
    assert kinds[0] == "curve"
    assert len(sent[0][1]["pv"]) == 400
    state = next(content for kind, content in sent if kind == "state")
    errors = [each["rmse_held_out"] for each in state["nodes"]]
    assert errors[1] < errors[0]
    desk.untick("deadband")
    desk.tick("deadband")
    again = sent[-1][1]
    assert [each["rmse_held_out"] for each in again["nodes"]] == errors  # the same node, not a new fit
    desk.leave_out(100.0, 140.0)
    left = sent[-1][1]
    assert (left["nodes"][-1]["effects"], left["model"]["left_out"]) == (["deadband"], [[100.0, 140.0]])
    known = {}
    monkeypatch.chdir(tmp_path)
    exec(left["python"], known)  # noqa: S102 - the lines that the page offers
    assert known["bench"].step.held_out.rmse == pytest.approx(left["nodes"][-1]["rmse_held_out"])
    command = "slipjump compare a.csv --op u --pv y --add deadband"
    assert left["command"] == f"{command}  # with the whole record: see Python"
    assert again["command"] == command
    desk.validate(Opening(tmp_path / "a.csv", "a.csv", columns={"OP": "u", "PV": "y"}))
    assert all(each["rmse_validation"] > 0 for each in sent[-1][1]["nodes"])
    assert desk.report().startswith("<!DOCTYPE html>")
