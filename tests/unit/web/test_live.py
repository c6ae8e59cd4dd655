"""Streams of changes: bounded, whole again after a drop, and gone with their clients."""

import asyncio
import gc
import json
import tracemalloc

from agent.web.event_stream import EventStream
from agent.web.live import MOST_PAGES, QUEUE, Live, Page


async def test_a_page_gets_its_full_state_then_what_changed():
    page = Page(lambda look: look)
    page.offer({"a": 1, "b": 2})
    page.offer({"a": 1, "b": 2})
    page.offer({"a": 3})
    assert json.loads(await page.next()) == {"full": True, "parts": {"a": 1, "b": 2}}
    assert json.loads(await page.next()) == {"full": False, "parts": {"a": 3, "b": None}}
    assert len(page) == 0


async def test_a_page_that_never_reads_keeps_little_and_gets_all_again():
    page = Page(lambda look: look)
    for k in range(1000):
        page.offer({"row": "x" * 1000, "count": k})
    gc.collect()
    tracemalloc.start()
    before = tracemalloc.get_traced_memory()[0]
    for k in range(1000, 11_000):
        page.offer({"row": "x" * 1000, "count": k})
    gc.collect()
    grown = tracemalloc.get_traced_memory()[0] - before
    tracemalloc.stop()
    assert len(page) <= QUEUE
    assert grown < 50_000
    first = json.loads(await page.next())
    assert first["full"]
    assert first["parts"]["row"] == "x" * 1000
    while len(page):
        last = json.loads(await page.next())
    assert last["parts"]["count"] == 10_999


async def test_pages_are_looked_at_while_they_are_open_and_end_with_the_server():
    looks = []

    async def look():
        return len(looks)

    live = Live(look, period=0.001)
    work = asyncio.create_task(live.run())
    page = await live.open(lambda look: looks.append(look) or {"look": look})
    assert json.loads(await page.next())["full"]
    assert json.loads(await page.next())["parts"]["look"] > 0
    work.cancel()
    await asyncio.wait({work})
    while await page.next() is not None:
        pass
    assert page.ended


async def nothing():
    return 0


async def test_pages_are_bounded_in_number():
    live = Live(nothing)
    opened = [await live.open(lambda _: {}) for _ in range(MOST_PAGES + 1)]
    assert opened[-1] is None
    live.close(opened[0])
    assert await live.open(lambda _: {}) is not None


async def test_a_client_that_is_gone_leaves_nothing_behind():
    live = Live(nothing)
    page = await live.open(lambda look: {"look": look})
    sent, gone = [], asyncio.Event()

    async def receive():
        await gone.wait()
        return {"type": "http.disconnect"}

    async def send(message):
        sent.append(message)
        if len(sent) == 2:
            gone.set()

    await EventStream(page, lambda: live.close(page))({"type": "http"}, receive, send)
    assert sent[1]["body"].startswith(b'data: {"full":true')
    assert not live.pages


async def test_silence_has_a_sign_of_life():
    page, sent = Page(lambda look: look), []
    never = asyncio.Event()

    async def send(message):
        sent.append(message)
        if len(sent) == 3:
            page.end()

    await EventStream(page, lambda: None, heartbeat=0.001)({"type": "http"}, never.wait, send)
    assert sent[1]["body"] == b": alive\n\n"
    assert not sent[-1]["more_body"]


async def test_a_view_that_takes_long_shows_one_look_after_the_other():
    """A look that came later is never overtaken by one that began before it."""
    first = asyncio.Event()

    async def view(look):
        if look == 1:
            await first.wait()
        return {"look": look}

    page = Page(view)
    seeing = [asyncio.create_task(page.see(look)) for look in (1, 2)]
    await asyncio.sleep(0)
    assert len(page) == 0
    first.set()
    await asyncio.gather(*seeing)
    assert [json.loads(await page.next())["parts"]["look"] for _ in range(2)] == [1, 2]
