"""Routes of the page on an agent whose windows are judged by hand, and the work list of a large plant."""

import asyncio
import gzip
import json
from contextlib import asynccontextmanager
from types import SimpleNamespace

import numpy as np
import pytest
from starlette.applications import Starlette

from agent.alarms import Alarm, State
from agent.analysis.diagnosis import Diagnosis
from agent.analysis.results import IntervalEstimate, MethodResult, Quantification, StictionEstimate
from agent.report.ranking import GROUPS, group_of
from agent.runtime.agent import Agent
from agent.runtime.loop.workers import InlineExecutor
from agent.settings import AgentSettings, AlarmSettings, ConnectionSettings, HttpSettings, Settings
from agent.web.plant import Look, Plant
from agent.web.plant_page import address, plant_page
from agent.web.ranking import Item, area_of, widest
from agent.web.rows import row_of, sparkline_of
from agent.web.screens.work_list import Wanted, listed, map_of
from connectors.options import Options
from tests.unit.runtime.agents import stream
from tests.unit.runtime.fake_bus import FakeBus
from tests.unit.runtime.loops import START, loop_settings
from tests.unit.web.clients import client, csrf

HOSTILE = "<script>alert(1)<script>"


def estimate(value):
    return IntervalEstimate(value, 0.9 * value, 1.1 * value)


def found(window, decision="stiction", s=4.0):
    each = estimate(s)
    return Quantification(
        quantifier="free_run",
        stiction=StictionEstimate(each, each, each, each, True, False),
        process=None,
        free_run_percent=90.0,
        linear_percent=40.0,
        evidence=3.0,
        decision=decision,
        model_pv=np.zeros(len(window)),
        model_mv=np.zeros(len(window)),
    )


def judge(window, _seen=None):
    return Diagnosis(
        loop=window.loop,
        verdict="no_stiction" if window.loop == HOSTILE else "stiction",
        confidence=0.99,
        cause="stiction",
        causes=(),
        stiction_class="stick_slip",
        oscillation=None,
        quantification=found(window),
        methods={"kano_a": MethodResult("stiction", 0.5, "PV <b>stays</b> while OP moves")},
    )


@asynccontextmanager
async def plant_of(loops=("FIC101", HOSTILE)):
    """A client of the page of an agent that has judged the first window of each loop."""
    agent = Agent(
        Settings(
            AgentSettings(clock_error=None),
            {"bus": ConnectionSettings("fake", Options())},
            tuple(
                loop_settings(name, quantify="always", alarm=AlarmSettings(on_delay=1, off_delay=1))
                for name in loops
            ),
        ),
        InlineExecutor(),
        connectors=[FakeBus(stream(loops, 60, step=0.0))],
        diagnose=judge,
        clock=lambda: START + 60,
    )
    plant = Plant(agent, lambda: START + 60)
    work = asyncio.create_task(agent.run())
    try:
        async with asyncio.timeout(30):
            while any(each.verdict_age is None or each.samples < 120 for each in agent.status()):  # noqa: ASYNC110
                await asyncio.sleep(0.01)
        app = plant_page(plant)(Starlette(), HttpSettings(), None)
        async with client(app) as web:
            yield web, plant
    finally:
        work.cancel()
        await asyncio.wait({work})


async def test_the_work_list_ranks_what_sticks_first():
    async with plant_of() as (web, _):
        said = (await web.get("/api/work-list")).json()
        assert [row["loop"] for row in said["rows"]] == ["FIC101", HOSTILE]
        first = said["rows"][0]
        assert (first["verdict"], first["group"], first["alarm"]) == ("stiction", "sticks", "unacked_active")
        assert first["s"] == {"value": 4.0, "low": pytest.approx(3.6), "high": pytest.approx(4.4)}
        assert first["probability"] == pytest.approx(0.2)  # the base rate: its one window says nothing
        assert first["next"].startswith("bump test")
        assert (said["counts"]["sticks"], said["counts"]["healthy"]) == (1, 1)
        assert (await web.get("/api/work-list?group=nonsense")).status_code == 422
        assert (await web.get("/api/work-list?search=script")).json()["rows"][0]["loop"] == HOSTILE


async def test_every_answer_about_a_loop_is_json_or_a_file_and_a_wrong_name_is_404():
    async with plant_of() as (web, _):
        about = (await web.get("/api/loops/FIC101")).json()
        assert about["diagnosis"]["methods"]["kano_a"]["reason"] == "PV <b>stays</b> while OP moves"
        assert "recording" not in about["diagnosis"]
        assert about["window"]["seconds"] == 40.0
        model = (await web.get("/api/loops/FIC101/model")).json()
        assert len(model["pv"]) == len(model["model_pv"]) == 40
        held = (await web.get("/api/loops/FIC101/window")).json()
        assert len(held["columns"]["pv"]) == 60
        newer = (await web.get(f"/api/loops/FIC101/window?since={held['start'] + 55}")).json()
        assert newer["start"] == held["start"] + 56
        assert newer["columns"]["pv"] == held["columns"]["pv"][56:]
        lines = (await web.get("/api/loops/FIC101/window.csv")).text.splitlines()
        assert (lines[0], len(lines)) == ("time,PV,OP", 61)
        kinds = {each["kind"] for each in (await web.get("/api/loops/FIC101/history")).json()}
        assert kinds == {"diagnosis", "alarm"}
        for path in ("", "/model", "/window", "/window.csv", "/history", "/report", "/map", "/stream"):
            assert (await web.get(f"/api/loops/NOBODY{path}")).status_code == 404


async def test_names_and_reasons_are_escaped_in_the_report():
    async with plant_of() as (web, _):
        answer = await web.get(f"/api/loops/{HOSTILE}/report")
        assert answer.status_code == 200
        assert "<script" not in answer.text
        assert "&lt;script&gt;" in answer.text
        assert "script-src" not in answer.headers["content-security-policy"]
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert "src=" not in answer.text


async def test_an_acknowledgement_goes_the_way_of_orders_and_is_kept_with_its_comment():
    async with plant_of() as (web, plant):
        decision = {"action": "acknowledge", "by": "jane", "comment": "packing ordered"}
        assert (await web.post("/api/loops/FIC101/orders", json=decision)).status_code == 403
        head = await csrf(web)
        row = (await web.post("/api/loops/FIC101/orders", json=decision, headers=head)).json()
        assert (row["alarm"], row["by"]) == ("acked_active", "jane")
        assert plant.agent.orders.taken == 1
        again = await web.post("/api/loops/FIC101/orders", json=decision, headers=head)
        assert (again.status_code, "acked_active" in again.json()["detail"]) == (409, True)
        newest = (await web.get("/api/alarms/decisions")).json()[0]
        assert (newest["action"], newest["by"], newest["comment"]) == (
            "acknowledge",
            "jane",
            "packing ordered",
        )


@pytest.mark.parametrize(
    ("decision", "status"),
    [
        ({"action": "shelve", "by": "jane", "hours": 8}, 200),
        ({"action": "shelve", "by": "jane"}, 409),
        ({"action": "shelve", "by": "jane", "hours": -1}, 422),
        ({"action": "shelve", "by": "jane", "hours": 1e9}, 422),
        ({"action": "acknowledge", "by": ""}, 422),
        ({"action": "acknowledge", "by": "   "}, 409),
        ({"action": "explode", "by": "jane"}, 422),
        ({"action": "acknowledge", "by": "jane", "alarm": "another"}, 409),
        ({"action": "out_of_service", "by": "jane"}, 200),
    ],
)
async def test_decisions_that_make_no_sense_are_refused_with_a_reason(decision, status):
    async with plant_of(("FIC101",)) as (web, _):
        answer = await web.post("/api/loops/FIC101/orders", json=decision, headers=await csrf(web))
        assert answer.status_code == status
        assert status == 200 or answer.json()["detail"]


async def test_looks_follow_each_other_so_that_an_older_one_never_comes_last(monkeypatch):
    async with plant_of() as (_, plant):
        ends, look = [], plant._look

        async def slow_at_first():
            number = len(ends)
            ends.append(f"{number} began")
            if number == 0:
                await asyncio.sleep(0)  # others have their turn
            found = await look()
            ends.append(f"{number} ended")
            return found

        monkeypatch.setattr(plant, "_look", slow_at_first)
        await asyncio.gather(plant.look(), plant.look())
        assert ends == ["0 began", "0 ended", "2 began", "2 ended"]


async def test_alarms_and_system():
    async with plant_of() as (web, _):
        (alarm,) = (await web.get("/api/alarms")).json()
        assert (alarm["loop"], alarm["alarm"]) == ("FIC101", "unacked_active")
        system = (await web.get("/api/system")).json()
        assert system["connection:bus"]["up"]
        assert system["silent"]["never_count"] == 0


async def test_the_description_names_every_route_and_needs_no_other_host():
    async with plant_of() as (web, _):
        paths = (await web.get("/api/openapi.json")).json()["paths"]
        assert {
            "/api/work-list",
            "/api/loops/{name}",
            "/api/loops/{name}/orders",
            "/api/alarms",
            "/api/system",
        } <= (paths.keys())
        for path in ("/", "/loops/FIC101", "/alarms", "/system", "/api/docs"):
            assert "<div id=" in (await web.get(path)).text


def item_of(k, verdict="no_stiction", state=State.NORMAL):
    name = f"{k // 100:02d}-FIC-{k:04d}"
    diagnosis = judge_as(name, verdict, s=1.0 + k % 7)
    status = SimpleNamespace(
        loop=name, connection="dcs", bus="opcua", data="fresh", data_age=1.0, diagnosis=diagnosis
    )
    return Item(status, Alarm(name, state=state), group_of(diagnosis), area_of(name, {}), START, k)


def judge_as(name, verdict, s):
    each = estimate(s)
    return Diagnosis(
        loop=name,
        verdict=verdict,
        confidence=0.9,
        cause="undecided",
        causes=(),
        stiction_class=None,
        oscillation=None,
        quantification=Quantification(
            "free_run", StictionEstimate(each, each, each, each), None, None, None, None, "undecided"
        ),
    )


async def large(loops=5000):
    verdicts = ("stiction", "no_stiction", "undecided", "not_testable")
    items = tuple(item_of(k, verdicts[k % 4]) for k in range(loops))
    return await Look.of(START, items, None)


async def test_a_plant_of_5000_loops_sends_little():
    look = await large()
    parts = await listed(look, Wanted(size=50))
    assert parts["plant"]["widest"] == pytest.approx(widest(look.items))
    assert len(parts["order"]) == 50
    assert sum(parts["counts"][group] for group in GROUPS) == 5000
    rows = [row_of(look.by_name[name]) for name in parts["order"]]
    sparks = 50 * json.dumps({"pv": [100] * 48, "op": [100] * 48})
    assert len(json.dumps([parts, rows])) + len(sparks) < 60_000
    assert len(gzip.compress(json.dumps(await map_of(look)).encode())) < 60_000


async def test_pages_of_the_list_are_each_loop_once_in_any_order():
    look = await large(237)
    for sort in ("next", "name", "s", "probability", "since"):
        pages = [await listed(look, Wanted(sort=sort, page=page)) for page in range(5)]
        names = [name for page in pages for name in page["order"]]
        assert len(names) == len(set(names)) == 237


def test_areas_come_from_names_or_variables():
    assert area_of("11-FIC-204", {}) == "11"
    assert area_of("FIC204", {}) == "2xx"
    assert area_of("FIC204", {"area": "crude"}) == "crude"
    assert area_of("boiler", {}) == "plant"


async def test_a_sparkline_is_small_and_has_gaps_where_samples_are_missing():
    async with plant_of() as (_, plant):
        drawn = sparkline_of(plant.agent.pipelines["FIC101"])
        assert all(len(values) <= 48 for values in drawn.values())
        assert all(0 <= value <= 100 for value in drawn["pv"])


@pytest.mark.parametrize(
    ("host", "expected"),
    [
        ("127.0.0.1", "http://127.0.0.1:9187/"),
        ("0.0.0.0", "http://127.0.0.1:9187/"),  # noqa: S104
        ("::1", "http://[::1]:9187/"),
    ],
)
def test_the_address_is_one_that_a_browser_here_can_open(host, expected):
    assert address(SimpleNamespace(host=host, port=9187)) == expected
