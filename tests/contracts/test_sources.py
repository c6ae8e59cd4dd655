"""What every source must do, whatever it speaks: the same plant is read from each of them."""

import json
from contextlib import contextmanager
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
import psycopg
import pytest

from agent.cli import main
from connectors.base import ConfigError
from connectors.exports.recorded import ReadOptions
from connectors.sources.kinds import SOURCES, address_in, opened
from tests.contracts.sources_served import http_server, opcua
from tests.contracts.sources_served.history import END, GAP, START, TS, WORD, N, Value, expected, held
from tests.contracts.sources_served.influx import InfluxServer
from tests.contracts.sources_served.pi import PiServer

SPAN = ReadOptions(span=(START, END))
TABLE = "CREATE TABLE IF NOT EXISTS samples (tag text, ts {kind}, value {value}, quality text)"


@pytest.fixture(autouse=True)
def small_pages(monkeypatch):
    """Let a tag have many pages, the last of them full; pauses do not last."""
    monkeypatch.setattr("connectors.sources.pi_web_api.VALUES", 65)
    monkeypatch.setattr("connectors.sources.pi_web_api.POINTS", 2)
    monkeypatch.setattr("connectors.sources.influxdb.VALUES", 65)
    monkeypatch.setattr("connectors.sources.sql_table.ROWS", 65)
    monkeypatch.setattr("connectors.sources.json_client.PAUSE", 0.001)
    for name in ("SLIPJUMP_USER", "SLIPJUMP_PASSWORD", "SLIPJUMP_TOKEN"):
        monkeypatch.delenv(name, raising=False)


def as_text(values):
    """Return all tags as a long export."""
    lines = ["tag,time,value,quality"]
    for tag, each in ((tag, each) for tag, many in values.items() for each in many):
        moment = datetime.fromtimestamp(each.time, UTC).isoformat()
        lines.append(f"{tag},{moment},{each.value},{'Good' if each.good else 'Bad'}")
    return "\n".join(lines) + "\n"


@contextmanager
def a_file(request):
    path = request.getfixturevalue("tmp_path") / "plant.csv"
    path.write_text(as_text(held()))
    yield str(path), None


@contextmanager
def pi(_):
    server = PiServer()
    with http_server.served(server) as port:
        yield f"pi+http://127.0.0.1:{port}/piwebapi?server=PISRV", server


@contextmanager
def influxdb(_):
    server = InfluxServer()
    with http_server.served(server) as port:
        yield f"influxdb+http://127.0.0.1:{port}/plant?measurement=samples&tag=tag", server


def fill(postgres, kind="timestamptz", value="text"):
    with psycopg.connect(postgres.url, autocommit=True) as connection:
        connection.execute("DROP TABLE IF EXISTS samples")
        connection.execute(TABLE.format(kind=kind, value=value))
        with connection.cursor() as cursor, cursor.copy("COPY samples FROM STDIN") as copy:
            for tag, each in ((tag, each) for tag, many in held().items() for each in many):
                moment = each.time if "double" in kind else datetime.fromtimestamp(each.time, UTC)
                number = None if value != "text" and isinstance(each.value, str) else each.value
                copy.write_row((tag, moment, number, "Good" if each.good else "Bad"))


@contextmanager
def sql(request):
    postgres = request.getfixturevalue("postgres")
    fill(postgres)
    yield f"{postgres.url}?table=public.samples&time=ts&quality=quality", None


@contextmanager
def opc_ua(request):
    port, history = request.getfixturevalue("opcua_server")
    history.paging = "good"
    yield f"opc.tcp://127.0.0.1:{port}/plant", history


@pytest.fixture(scope="module")
def opcua_server():
    with opcua.served() as found:
        yield found


SERVED = {"": a_file, "pi+http": pi, "influxdb+http": influxdb, "postgresql": sql, "opc.tcp": opc_ua}


def test_every_source_is_tried():
    assert {scheme.replace("+https", "+http") for scheme in SOURCES} == set(SERVED)


@pytest.fixture(params=SERVED.values(), ids=[name or "file" for name in SERVED])
def source(request):
    """Address and server of one source."""
    with request.param(request) as found:
        yield found


def listed(address):
    with opened(address, SPAN) as found:
        return len(found.loops().loops)


def test_its_loops_are_listed_and_the_rest_is_named(source):
    with opened(source[0], SPAN) as found:
        listed = found.loops()
        assert listed.loops == ("FIC101", "TIC9")
        assert found.loops() == listed
        assert found.version() == opened(source[0], SPAN).version()
    said = "\n".join(listed.problems)
    assert "AI7: has no OP, it was left out" in said
    if not source[0].startswith("opc"):  # there only variables with a role are looked at
        assert "weather" in said


def test_a_loop_is_read_whole_once_and_within_the_span(source):
    with opened(source[0], SPAN) as found:
        read = found.read("FIC101")
        other = found.read("TIC9")
    np.testing.assert_allclose(read.time, START + TS * np.arange(N), atol=1e-5)
    np.testing.assert_array_equal(read.pv, expected("FIC101.PV"))
    np.testing.assert_array_equal(read.op, expected("FIC101.OP"))
    np.testing.assert_array_equal(read.sp, expected("FIC101.SP"))
    assert np.isnan(read.pv[[GAP, WORD]]).all()
    assert (read.name, read.duplicates, read.bad >= 1) == ("FIC101", 0, True)
    np.testing.assert_array_equal(other.pv, expected("TIC9.PV"))


def test_a_loop_that_is_not_there_is_named(source):
    with (
        opened(source[0], SPAN) as found,
        pytest.raises(ConfigError, match="has no loop 'X', it holds: FIC101"),
    ):
        found.read("X")


def test_closed_twice_is_closed(source):
    found = opened(source[0], SPAN)
    found.loops()
    found.close()
    found.close()


def test_commands_take_it_as_a_recording(source, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = ["--start", "2026-03-01T08:00", "--end", "2026-03-01T08:21:40"]
    with pytest.raises(SystemExit) as left:
        main(["diagnose", source[0], *words, "--json", "--loop", "FIC101"])
    printed = capsys.readouterr()
    assert left.value.code == 0, printed.err
    assert [json.loads(line)["loop"] for line in printed.out.splitlines()] == ["FIC101"]


def test_what_cannot_be_reached_is_one_fault_with_its_address():
    for address in (
        "pi+http://127.0.0.1:9/piwebapi",
        "influxdb+http://127.0.0.1:9/plant",
        "postgresql://nobody@127.0.0.1:9/plant?table=samples",
        "opc.tcp://127.0.0.1:9/",
    ):
        with pytest.raises(ConfigError) as fault, opened(address, SPAN) as found:
            found.loops()
        assert len(fault.value.faults) == 1
        assert fault.value.faults[0].startswith(address.split("?")[0])
        assert "\n" not in fault.value.faults[0]


@pytest.mark.parametrize("scheme", [scheme for scheme in SOURCES if scheme])
def test_a_password_in_an_address_is_refused_and_not_repeated(scheme):
    for address in (f"{scheme}://me:s3cret@host/x?table=t", f"{scheme}://me:s3%63ret@host:port/x"):
        with pytest.raises(ConfigError) as fault:
            opened(address, SPAN).loops()
        assert "s3" not in str(fault.value)


@pytest.mark.parametrize("scheme", [scheme for scheme in SOURCES if scheme])
def test_an_address_needs_a_span_and_known_parameters(scheme):
    with pytest.raises(ConfigError, match="name it by --start and --end"):
        opened(f"{scheme}://host/x?table=t", ReadOptions())
    with pytest.raises(ConfigError, match="unknown parameter 'colour'"):
        opened(f"{scheme}://host/x?table=t&colour=red", SPAN)
    with pytest.raises(ConfigError, match="expected a file, or an address with"):
        opened("ftp://host/x", SPAN)


def test_an_address_survives_being_taken_for_a_path(tmp_path):
    address = "pi+https://host:8443/piwebapi?server=A&filter=FIC*"
    assert address_in(Path(address)) == address
    for path in (tmp_path / "x.csv", Path("C:/data/x.csv"), Path("a:b.csv"), Path("plant/x.csv")):
        assert address_in(path) is None


@pytest.mark.parametrize("served", [pi, influxdb], ids=["pi", "influxdb"])
def test_a_tag_that_cannot_be_read_is_named_and_the_other_loops_are_read(served, request):
    with served(request) as (address, server), opened(address, SPAN) as found:
        found.loops()
        server.broken = True
        with pytest.raises(ConfigError, match=r"TIC9\.OP"):
            found.read("TIC9")
        assert len(found.read("FIC101").time) == N


@pytest.mark.parametrize("served", [pi, influxdb], ids=["pi", "influxdb"])
def test_a_page_of_one_time_does_not_loop_for_ever(served, request):
    with served(request) as (address, server), opened(address, SPAN) as found:
        server.stuck = True
        with pytest.raises(ConfigError, match=r"more than 65 values at"):
            found.read("FIC101")


@pytest.mark.parametrize("served", [pi, influxdb], ids=["pi", "influxdb"])
def test_a_busy_server_is_tried_again_and_a_closed_one_says_what_it_needs(served, request, monkeypatch):
    with served(request) as (address, server):
        server.busy = 2
        assert listed(address) == 2
        server.busy = 1000
        with pytest.raises(ConfigError, match=r"HTTP 503 .*, 4 times"):
            listed(address)
        server.busy, server.login = 0, ("me", "s3cret")
        with pytest.raises(ConfigError, match=r"access denied .*SLIPJUMP_USER and SLIPJUMP_PASSWORD"):
            listed(address)
        monkeypatch.setenv("SLIPJUMP_USER", "me")
        monkeypatch.setenv("SLIPJUMP_PASSWORD", "s3cret")
        assert listed(address) == 2
    with pytest.raises(ConfigError, match="credentials are sent over https only"):
        opened("pi+http://historian.plant.example/piwebapi", SPAN)


def test_a_mapping_spares_the_list_of_points(request):
    options = ReadOptions(span=(START, END), loops={"F": {"PV": "FIC101.PV", "OP": "FIC101.OP"}})
    with pi(request) as (address, server), opened(address, options) as found:
        assert found.loops().loops == ("F",)
        assert server.requests == []
        assert len(found.read("F").time) == N
        assert not any(path.endswith("points") and "dataservers/" in path for path in server.requests)


@pytest.mark.parametrize("paging", opcua.PAGING[1:])
def test_a_server_that_pages_badly_is_read_whole_or_named(request, paging, monkeypatch):
    monkeypatch.setattr("connectors.sources.opcua_history.VALUES", 65)
    with opc_ua(request) as (address, history), opened(address, SPAN) as found:
        found.loops()
        history.paging, history.requests = paging, 0
        if paging == "stuck":
            with pytest.raises(
                ConfigError, match="tag FIC101/PV: the server repeats the values at 2026-03-01"
            ):
                found.read("FIC101")
        else:
            np.testing.assert_array_equal(found.read("FIC101").pv, expected("FIC101.PV"))
        assert history.requests < 60
        history.paging = "good"


@pytest.mark.parametrize("kind", ["timestamptz", "timestamp", "double precision"])
def test_columns_of_a_table_may_have_any_type(postgres, kind):
    fill(postgres, kind, "numeric")
    with opened(f"{postgres.url}?table=samples&time=ts&quality=quality", SPAN) as found:
        np.testing.assert_array_equal(found.read("FIC101").pv, expected("FIC101.PV"))


@pytest.mark.parametrize(
    "wrong", ["table=nothing", "table=samples&time=when", "table=samples%22%3B+DROP+TABLE+samples%3B+--"]
)
def test_a_table_or_column_that_is_not_there_is_named(postgres, wrong):
    fill(postgres)
    with opened(f"{postgres.url}?{wrong}", SPAN) as found, pytest.raises(ConfigError, match="does not exist"):
        _ = found.loops(), found.read("FIC101")
    assert listed(f"{postgres.url}?table=samples&time=ts") == 2


def test_a_survey_takes_addresses(capsys, tmp_path):
    server = InfluxServer()
    server.points = {tag: each for tag, each in held().items() if tag.startswith("TIC9")}
    server.points["TIC9.OP"] = [Value(each.time, 40.0) for each in server.points["TIC9.OP"]]
    server.broken = True
    with http_server.served(server) as port:
        address = f"influxdb+http://127.0.0.1:{port}/plant?measurement=samples&tag=tag"
        words = ["survey", address, "--start", "2026-03-01T08:00", "--end", "2026-03-01T08:21:40"]
        for code in (2, 0):
            with pytest.raises(SystemExit) as left:
                main([*words, "-o", str(tmp_path / "out"), "--workers", "1"])
            printed = capsys.readouterr()
            assert left.value.code == code
            assert ("tag TIC9.OP: shard" in printed.err) == server.broken
            server.broken = False
    assert "1 recording of 1 valve: 1 not testable" in printed.out
