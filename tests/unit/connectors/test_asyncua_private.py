"""What is used of asyncua's insides is there, is named when it is not, and is used in one file only."""

import re

import pytest
from asyncua.server.monitored_item_service import MonitoredItemService

from connectors.opcua_server import asyncua_private
from tests.conftest import ROOT

OF_ANOTHER = re.compile(r"(?<!\bself)(?<!\bcls)\._(?!_)[a-z]\w*")
OF_ASYNCUA = re.compile(
    r"\._(?:" + "|".join(name[1:] for _, names in asyncua_private.MEMBERS for name in names) + r")\b"
)


def test_the_installed_asyncua_has_every_member():
    assert asyncua_private.missing() == [], "change connectors/opcua_server/asyncua_private.py"


def test_a_missing_member_is_named(monkeypatch):
    monkeypatch.delattr(MonitoredItemService, "_trigger_event")
    monkeypatch.setattr(MonitoredItemService, "__init__", lambda *_: None)
    assert asyncua_private.missing() == [
        "MonitoredItemService._monitored_items",
        "MonitoredItemService._monitored_events",
        "MonitoredItemService._trigger_event",
    ]


def sources():
    folders = ("connectors/opcua", "connectors/opcua_server", "simulators/servers")
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    return [path for path in files if "asyncua" in path.read_text(encoding="utf-8")]


@pytest.mark.parametrize("path", sources(), ids=lambda path: str(path.relative_to(ROOT)))
def test_no_other_file_uses_a_private_member(path):
    text = path.read_text(encoding="utf-8")
    if path.name == "asyncua_private.py":
        assert OF_ANOTHER.search(text)
    else:
        assert OF_ANOTHER.findall(text) == []
        assert [name for name in OF_ASYNCUA.findall(text) if name != "._server"] == []


def test_every_private_member_that_the_file_uses_is_listed():
    text = (ROOT / "connectors/opcua_server/asyncua_private.py").read_text(encoding="utf-8")
    listed = {name for _, names in asyncua_private.MEMBERS for name in names}
    assert set(re.findall(r"\.(_(?!_)\w+)", text)) == listed
