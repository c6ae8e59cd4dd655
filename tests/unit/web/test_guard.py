"""The door of the page: names, tokens, cookies, CSRF tokens, sizes."""

import pytest
from fastapi import APIRouter, Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from agent.web.access import LASTS, LOOPBACK, Access
from agent.web.app import application
from agent.web.screens.screen import PageScreen
from tests.unit.web.clients import client, csrf

TOKEN = "a-long-token"  # noqa: S105


def app_of(access=None):
    router = APIRouter()

    @router.post("/api/thing")
    async def thing(request: Request):
        return {"size": len(await request.body())}

    async def live(_):
        return PlainTextResponse("ok\n")

    screens = [PageScreen("work_list", "Work list", "/", router, {"/api/thing": 100_000})]
    return application(screens, access or Access(), [Route("/live", live)])


async def test_no_answer_of_the_page_leads_to_the_host_that_the_caller_named():
    async with client(app_of(Access(hosts=None)), "evil.example") as web:
        for path in ("/live/", "/health/", "/api/session/", "/api/thing/"):
            answer = await web.get(path, follow_redirects=False)
            assert (answer.status_code, answer.headers.get("location")) == (404, None), path


async def test_without_a_token_nothing_but_live_answers():
    async with client(app_of(Access(TOKEN, None)), "plant:9187") as web:
        assert (await web.get("/live")).status_code == 200
        for path in (
            "/",
            "/api/session",
            "/api/docs",
            "/api/openapi.json",
            "/static/app.js",
            "/static/",
            "/health",
        ):
            answer = await web.get(path)
            assert (answer.status_code, TOKEN in answer.text) == (401, False), path
        form = await web.get("/", headers={"Accept": "text/html"})
        assert (form.status_code, "<form" in form.text, "<script" in form.text) == (401, True, False)
        assert (await web.post("/api/thing")).status_code == 401
        assert (await web.post("/sign-in", data={"token": "wrong"})).status_code == 401


async def test_the_token_is_exchanged_for_a_cookie_that_scripts_and_other_sites_do_not_get():
    now = [1e9]
    access = Access(TOKEN, None, lambda: now[0])
    async with client(app_of(access), "plant:9187") as web:
        answer = await web.post("/sign-in", data={"token": TOKEN})
        cookie = answer.headers["set-cookie"]
        assert (answer.status_code, answer.headers["location"]) == (303, "/")
        assert "HttpOnly" in cookie
        assert "samesite=strict" in cookie.lower()
        assert TOKEN not in cookie
        assert (await web.get("/api/session")).status_code == 200
        now[0] += LASTS + 1
        assert (await web.get("/api/session")).status_code == 401


@pytest.mark.parametrize("forged", ["", "x", "9999999999.abc.00", "9999999999.abc", "ü.1.2"])
async def test_a_forged_cookie_is_none(forged):
    assert Access(TOKEN).session_of(f"slipjump={forged}") is None
    other = Access("another")
    assert Access(TOKEN).session_of(f"slipjump={other.new_cookie()}") is None


async def test_what_changes_state_needs_the_csrf_token_of_its_session():
    access = Access(TOKEN, None)
    async with client(app_of(access), "plant:9187") as web:
        await web.post("/sign-in", data={"token": TOKEN})
        assert (await web.post("/api/thing")).status_code == 403
        assert (
            await web.post("/api/thing", headers={"X-CSRF-Token": access.csrf_token("")})
        ).status_code == 403
        assert (await web.post("/api/thing", headers=await csrf(web))).status_code == 200


async def test_a_program_that_bears_the_token_needs_no_csrf_token():
    async with client(app_of(Access(TOKEN, None)), headers={"Authorization": f"Bearer {TOKEN}"}) as web:
        assert (await web.post("/api/thing", content=b"12")).json() == {"size": 2}


async def test_on_loopback_no_token_is_needed_but_the_csrf_token_is():
    async with client(app_of()) as web:
        assert (await web.get("/")).status_code == 200
        assert (await web.post("/api/thing")).status_code == 403
        assert (await web.post("/api/thing", headers=await csrf(web))).status_code == 200


@pytest.mark.parametrize("host", ["evil.example", "evil.example:9187", "127.0.0.1.evil.example", ""])
async def test_another_name_for_loopback_is_refused(host):
    async with client(app_of()) as web:
        assert (await web.get("/api/session", headers={"Host": host})).status_code == 421
        assert (await web.get("/live", headers={"Host": host})).status_code == 200


def test_names_of_loopback_are_known_with_and_without_a_port():
    assert all(Access().knows_host(name) and Access().knows_host(f"{name}:80") for name in LOOPBACK)


async def test_a_large_body_is_refused_where_no_upload_belongs():
    async with client(app_of()) as web:
        head = await csrf(web)
        assert (await web.post("/api/thing", content=b"x" * 90_000, headers=head)).json() == {"size": 90_000}
        assert (await web.post("/api/thing", content=b"x" * 100_001, headers=head)).status_code == 413
        assert (await web.post("/api/other", content=b"x" * 70_000, headers=head)).status_code == 413


async def test_a_body_that_hides_its_length_is_refused_in_words_as_soon_as_it_is_too_large():
    taken = []

    async def endless():
        while True:
            taken.append(None)
            yield b"x" * 10_000

    async with client(app_of()) as web:
        answer = await web.post("/api/thing", content=endless(), headers=await csrf(web))
    assert (answer.status_code, answer.json()["detail"]) == (413, "the body is larger than 100000 bytes")
    assert len(taken) < 20


async def test_only_own_scripts_run_and_nobody_frames_the_page():
    async with client(app_of()) as web:
        for path in ("/", "/api/session", "/api/nothing", "/static/app.js"):
            policy = (await web.get(path)).headers["content-security-policy"]
            assert "default-src 'none'" in policy
            assert "script-src 'self'" in policy
            assert "frame-ancestors 'none'" in policy
            assert "unsafe" not in policy
