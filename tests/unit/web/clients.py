"""Clients of the page's application without a socket."""

import httpx


def client(app, host="127.0.0.1:9187", **options):
    """A client that calls the application by a name."""
    transport = httpx.ASGITransport(app=app)
    return httpx.AsyncClient(transport=transport, base_url=f"http://{host}", **options)


async def csrf(web):
    """The header that requests need which change state."""
    return {"X-CSRF-Token": (await web.get("/api/session")).json()["csrf"]}
