"""InfluxDB 1.x itself, where Debian's package is installed: as ours answers in `sources_served`."""

import shutil
import subprocess
import time

import httpx
import numpy as np
import pytest

from connectors.exports.recorded import ReadOptions
from connectors.sources.kinds import opened
from tests.contracts.sources_served.history import END, START, N, expected, held
from tests.ports import free_port

pytestmark = pytest.mark.bench
CONFIG = """
reporting-disabled = true
bind-address = "127.0.0.1:{rpc}"
[meta]
dir = "{folder}/meta"
[data]
dir = "{folder}/data"
wal-dir = "{folder}/wal"
[http]
bind-address = "127.0.0.1:{port}"
log-enabled = false
"""


@pytest.fixture(scope="module")
def influxdb(tmp_path_factory):
    """Address of a running server with the plant of the tests, as one measurement and as many."""
    program = shutil.which("influxd")
    if program is None:
        pytest.skip("influxd is missing: apt-get install influxdb")
    folder, port = tmp_path_factory.mktemp("influx"), free_port()
    (folder / "influx.conf").write_text(CONFIG.format(folder=folder, port=port, rpc=free_port()))
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    server = subprocess.Popen([program, "-config", str(folder / "influx.conf")], **quiet)
    try:
        base, end = f"http://127.0.0.1:{port}", time.monotonic() + 60
        while True:
            try:
                post(f"{base}/query?q=CREATE+DATABASE+plant", b"")
                break
            except httpx.TransportError:
                assert time.monotonic() < end
                time.sleep(0.05)
        lines = []
        for tag, each in ((tag, each) for tag, many in held().items() for each in many):
            if each.good and not isinstance(each.value, str):
                at = round(each.time * 1e9)
                loop, _, field = tag.rpartition(".")
                lines += [f"samples,tag={tag} value={each.value} {at}"]
                lines += [f"{loop} {field}={each.value} {at}"] if loop else []
        post(f"{base}/write?db=plant", "\n".join(lines).encode())
        yield f"influxdb+{base}/plant"
    finally:
        server.kill()
        server.wait()


def post(url, body):
    httpx.post(url, content=body).raise_for_status()


@pytest.mark.parametrize("layout", ["?measurement=samples&tag=tag", ""], ids=["one measurement", "many"])
def test_the_plant_is_read_from_the_real_server(influxdb, layout, monkeypatch):
    monkeypatch.setattr("connectors.sources.influxdb.VALUES", 65)
    with opened(f"{influxdb}{layout}", ReadOptions(span=(START, END))) as found:
        assert found.loops().loops == ("FIC101", "TIC9")
        read, other = found.read("FIC101"), found.read("TIC9")
    kept = np.isfinite(expected("FIC101.PV"))  # what had no value was not written
    np.testing.assert_array_equal(read.pv, expected("FIC101.PV")[kept])
    np.testing.assert_array_equal(read.op, expected("FIC101.OP")[kept])
    assert len(other.time) == N
