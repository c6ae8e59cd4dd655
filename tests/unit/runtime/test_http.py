"""Health and metrics as Prometheus and people get them: a real server, asked over a socket."""

import asyncio
import json
import re
import socket
import urllib.error
import urllib.request

import pytest
import yaml
from prometheus_client.parser import text_string_to_metric_families

from agent.runtime.operate import patient_http
from agent.runtime.operate.http import serve
from agent.runtime.operate.metrics import Metrics
from agent.runtime.supervisor import Health, keep_alive
from agent.settings import HttpSettings, settings_of
from connectors.base import ConfigError
from tests.conftest import ROOT
from tests.ports import free_port
from tests.unit.runtime.agents import agent_of, stream
from tests.unit.runtime.fake_bus import FakeBus


def get(port, path, token=None):
    """Status and body."""
    headers = {} if token is None else {"Authorization": f"Bearer {token}"}
    request = urllib.request.Request(f"http://127.0.0.1:{port}{path}", headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=30) as answer:  # noqa: S310
            return answer.status, answer.read().decode()
    except urllib.error.HTTPError as error:
        with error:
            return error.code, error.read().decode()


async def asked(*question, **options):
    return await asyncio.to_thread(get, *question, **options)


async def until(condition):
    async with asyncio.timeout(30):
        while not condition():  # noqa: ASYNC110 - a state of the agent is no event
            await asyncio.sleep(0.01)


async def served(agent, port, token=None, scenario=None):
    """Run an agent with its server, and a scenario meanwhile."""
    metrics = Metrics(agent.looked)
    agent.observe(metrics)
    health = Health("http")
    settings = HttpSettings(port=port, token=token)
    agent.accompany(health, lambda: serve(settings, agent, metrics, health.works))
    task = asyncio.create_task(agent.run())
    try:
        await until(lambda: health.up)
        return await scenario()
    finally:
        task.cancel()
        await asyncio.wait({task})


def numbers(text):
    """Name and labels -> value."""
    return {
        (sample.name, *sample.labels.values()): sample.value
        for family in text_string_to_metric_families(text)
        for sample in family.samples
    }


async def test_a_daemon_at_work_is_healthy_and_its_numbers_say_so():
    bus = FakeBus(stream(["FIC101"], 5000, step=0.002))
    agent, port = agent_of(bus, quantify="always"), free_port()

    async def scenario():
        await until(lambda: len(bus.published) >= 4)
        return [await asked(port, path) for path in ("/health", "/metrics", "/live", "/other")]

    (code, health), (_, text), live, other = await served(agent, port, scenario=scenario)
    said = json.loads(health)
    assert (code, said["status"], said["hung"]) == (200, "ok", [])
    assert said["connections"]["bus"]["up"] is True
    loop = said["loops"]["FIC101"]
    assert (loop["data"], loop["verdict"], loop["alarm"]) == ("fresh", "stiction", "unacked_active")
    assert 0 <= loop["data_age_s"] < 60
    assert live == (200, "ok\n")
    assert other[0] == 404
    value = numbers(text)
    assert value["slipjump_loop_samples_total", "FIC101"] >= 800
    assert value["slipjump_diagnoses_total", "FIC101", "stiction"] >= 3
    assert value["slipjump_fit_seconds_count",] == value["slipjump_window_seconds_count",] >= 3
    assert value["slipjump_alarms", "unacked_active"] == value["slipjump_loop_alarm_active", "FIC101"] == 1
    assert value["slipjump_alarm_changes_total", "unacked_active"] == 1
    assert value["slipjump_connection_up", "bus"] == 1
    assert value["slipjump_loop_stale", "FIC101"] == value["slipjump_hung",] == 0
    assert ("process_resident_memory_bytes",) in value


async def test_a_plant_that_is_away_is_reported_but_is_no_reason_to_start_anew():
    bus = FakeBus(None)
    bus.refuses_connection = True
    agent, port = agent_of(bus), free_port()

    async def scenario():
        await until(lambda: agent.connections[0].health.losses >= 2)
        return [await asked(port, path) for path in ("/health", "/live", "/metrics")]

    (code, health), live, (_, text) = await served(agent, port, scenario=scenario)
    said = json.loads(health)
    assert (code, said["status"], live) == (503, "degraded", (200, "ok\n"))
    assert (said["connections"]["bus"]["error"], said["loops"]["FIC101"]["data"]) == ("refused", "none")
    value = numbers(text)
    assert (
        value["slipjump_connection_up", "bus"],
        value["slipjump_connection_losses_total", "bus"] >= 2,
    ) == (
        0,
        True,
    )
    assert ("slipjump_loop_data_age_seconds", "FIC101") not in value  # not known is not zero


async def test_a_state_file_that_cannot_be_written_is_unhealthy_with_the_reason_and_still_alive(tmp_path):
    agent, port = agent_of(FakeBus(stream(["FIC101"], 3600, step=0.05))), free_port()
    agent.journal._path = tmp_path / "not yet" / "plant.sqlite"

    async def scenario():
        await until(lambda: agent.journal.problem)
        return [await asked(port, path) for path in ("/health", "/live")]

    (code, health), live = await served(agent, port, scenario=scenario)
    said = json.loads(health)
    assert (code, said["status"], live) == (503, "degraded", (200, "ok\n"))
    assert "plant.sqlite" in said["store_error"]


async def test_who_shows_no_token_learns_nothing_but_that_it_lives(tmp_path):
    (tmp_path / "token").write_text("s3cret\n")
    agent, port = agent_of(FakeBus(stream(["FIC101"], 5000))), free_port()

    async def scenario():
        tokens = (None, "", "s3cre", "s3cret")
        codes = [(await asked(port, path, token=t))[0] for path in ("/metrics", "/health") for t in tokens]
        return codes, (await asked(port, "/live"))[0]

    codes, live = await served(agent, port, {"file": str(tmp_path / "token")}, scenario)
    assert codes[:4] == [401, 401, 401, 200]
    assert codes[4:7] == [401, 401, 401]
    assert live == 200


async def test_an_address_that_is_taken_is_had_when_it_is_free(caplog):
    agent = agent_of(FakeBus(None))
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port, health = other.getsockname()[1], Health("http")
        work = keep_alive(
            lambda: serve(HttpSettings(port=port), agent, Metrics(agent.looked), health.works),
            health,
            0.05,
        )
        task = asyncio.create_task(work)
        await until(lambda: health.losses >= 3)
    await until(lambda: health.up)
    assert (await asked(port, "/live"))[0] == 200
    task.cancel()
    await asyncio.wait({task})
    assert caplog.text.count("http is down: cannot listen: Address already in use") == 1


async def test_the_page_lists_every_metric_and_no_other():
    text = b"".join([part async for part in Metrics(agent_of(FakeBus(None)).looked).parts()]).decode()
    there = {
        name.removesuffix("_total") for name in re.findall(r"^# TYPE (slipjump_\w+) ", text, re.MULTILINE)
    }
    there = {name for name in there if not name.endswith("_created")}
    page = (ROOT / "docs" / "howto" / "monitoring.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `slipjump_")]
    listed = [name.removesuffix("_total") for row in rows for name in re.findall(r"`(\w+)`", row)]
    assert sorted(listed) == sorted(there)
    rules = yaml.safe_load(re.search(r"```yaml\n(groups:.*?)```", page, re.DOTALL)[1])["groups"][0]["rules"]
    used = {name for rule in rules for name in re.findall(r"slipjump_\w+", rule["expr"])}
    assert {name.removesuffix("_total") for name in used} <= there


@pytest.mark.parametrize(
    ("http", "fault"),
    [
        ({"host": "192.0.2.1"}, "expected a token"),
        ({"host": "scada.example"}, "expected a token"),
        ({"host": "::"}, "expected a token"),
        ({"token": "s3cret"}, "does not belong in this file"),
        ({"host": "192.0.2.1", "token": {"env": "TOKEN"}}, None),
        ({"host": "::1"}, None),
        ({"host": "localhost"}, None),
    ],
)
def test_beyond_this_machine_a_token_is_a_must(http, fault):
    raw = {"agent": {"http": http}, "connections": {"b": {"kind": "mqtt"}}, "loops": [{}]}
    with pytest.raises(ConfigError) as caught:
        settings_of(raw)
    told = [each for each in caught.value.faults if each.startswith("agent.http")]
    assert told == [] if fault is None else fault in told[0]
    assert "s3cret" not in str(caught.value)


async def test_silent_and_half_open_clients_give_way_and_live_always_answers(monkeypatch):
    monkeypatch.setattr(patient_http, "REQUEST_WITHIN", 0.3)
    monkeypatch.setattr(patient_http, "MOST_CONNECTIONS", 20)
    port = free_port()

    async def scenario():
        silent = [await asyncio.open_connection("127.0.0.1", port) for _ in range(60)]
        for _, writer in silent[::2]:
            writer.write(b"GET /metrics HTTP/1.1\r\nHost: x\r\nX-Slow:")  # and never ends
        assert await asked(port, "/live") == (200, "ok\n")
        for reader, _ in silent:
            await asyncio.wait_for(reader.read(), 30)  # each is closed by the server
        assert (await asked(port, "/metrics"))[0] == 200
        for _, writer in silent:
            writer.close()

    await served(agent_of(FakeBus(stream(["FIC101"], 10))), port, scenario=scenario)


async def test_beyond_the_most_connections_a_silent_one_is_closed_for_each_that_comes(monkeypatch):
    monkeypatch.setattr(patient_http, "REQUEST_WITHIN", 3600.0)  # time closes none of them
    monkeypatch.setattr(patient_http, "MOST_CONNECTIONS", 20)
    port = free_port()

    async def scenario():
        silent = [await asyncio.open_connection("127.0.0.1", port) for _ in range(50)]
        ends = [asyncio.create_task(reader.read()) for reader, _ in silent]
        await until(lambda: sum(each.done() for each in ends) >= 30)
        assert await asked(port, "/live") == (200, "ok\n")
        for _, writer in silent:
            writer.close()
        await asyncio.gather(*ends, return_exceptions=True)

    await served(agent_of(FakeBus(stream(["FIC101"], 10))), port, scenario=scenario)


async def test_live_is_answered_in_a_crowd_where_others_get_503(monkeypatch):
    monkeypatch.setattr(patient_http, "MOST_REQUESTS", 0)
    port = free_port()

    async def scenario():
        assert (await asked(port, "/live"))[0] == 200
        assert (await asked(port, "/metrics"))[0] == 503

    await served(agent_of(FakeBus(stream(["FIC101"], 10))), port, scenario=scenario)


async def test_no_answer_leads_to_the_host_that_the_caller_named():
    port = free_port()

    async def scenario():
        for path in ("/health/", "/live/", "/metrics/"):
            assert (await asked(port, path))[0] == 404

    await served(agent_of(FakeBus(stream(["FIC101"], 10))), port, scenario=scenario)
