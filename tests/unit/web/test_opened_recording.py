"""A recording that the command line opened is what the printed address shows, while its session lives."""

from types import SimpleNamespace

import pytest

from agent.web.access import LOOPBACK, Access
from agent.web.app import application
from agent.web.screens import workbench
from tests.unit.web.clients import client


@pytest.fixture
def sessions():
    return SimpleNamespace(open={"abc": None})


@pytest.fixture
def app(sessions):
    return application(
        [workbench.screen(sessions, path="/")],
        Access(None, LOOPBACK),
        [workbench.leads_to(sessions, "abc")],
    )


async def test_the_address_leads_to_the_session(app):
    async with client(app) as web:
        answer = await web.get("/")
        assert answer.status_code == 307
        assert answer.headers["location"] == "/?session=abc"
        assert "text/html" in (await web.get(answer.headers["location"])).headers["content-type"]


async def test_after_its_end_another_recording_can_be_opened(app, sessions):
    sessions.open.clear()
    async with client(app) as web:
        assert (await web.get("/")).status_code == 200
