"""The door: who comes in, by which name, with how large a body; and headers that every answer carries."""

from __future__ import annotations

import asyncio
import urllib.parse
from collections.abc import Mapping

from starlette.datastructures import Headers, MutableHeaders
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import HTMLResponse, JSONResponse, PlainTextResponse, RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from agent.web.access import COOKIE, LASTS, Access
from agent.web.sign_in import sign_in_page

FREE = frozenset({"/live"})
"""Answers without a token and under any name."""
SIGN_IN = "/sign-in"
SAFE = frozenset({"GET", "HEAD", "OPTIONS"})
BODY = 64 * 1024
"""Largest body of a request, bytes, where a screen allows no more."""
WRONG_TOKEN_WAIT = 0.5
"""Time that a wrong token costs, s."""
HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' data:; connect-src 'self'; form-action 'self'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
}
Uploads = Mapping[str, int]


class Guard:
    """Stands before an application of ASGI."""

    def __init__(self, app: ASGIApp, access: Access, uploads: Uploads | None = None) -> None:
        """Make it.

        Args:
            app: What it guards.
            access: The rules.
            uploads: Path -> largest body there, bytes, where that is more than usual.
        """
        self._app = app
        self._access = access
        self._uploads = uploads or {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request, or pass it on."""
        if scope["type"] != "http" or scope["path"] in FREE:
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refusal = await self._refusal(scope, headers, Request(scope, receive))
        if refusal is not None:
            await refusal(scope, receive, _with_headers(send))
            return
        limit = self._uploads.get(scope["path"], BODY)
        if int(headers.get("content-length", "0") or 0) > limit:
            await JSONResponse({"detail": _too_large(limit)}, 413)(scope, receive, _with_headers(send))
            return
        await self._app(scope, _bounded(receive, limit), _with_headers(send))

    async def _refusal(self, scope: Scope, headers: Headers, request: Request) -> Response | None:
        """Return the answer to who may not come in, or who signs in; None where the request may pass."""
        access = self._access
        if not access.knows_host(headers.get("host", "")):
            return PlainTextResponse("this server is not known by that name\n", 421)
        if not headers.get("content-length", "0").isdigit():
            return PlainTextResponse("Content-Length is no number\n", 400)
        if access.token is not None and scope["path"] == SIGN_IN and scope["method"] == "POST":
            return await self._signed_in(headers, request)
        bears = access.bears_token(headers.get("authorization", ""))
        session = "" if access.token is None else access.session_of(headers.get("cookie", ""))
        if session is None and not bears:
            return _token_needed(headers, scope)
        scope.setdefault("state", {})["session"] = session or ""
        shown = headers.get("x-csrf-token", "")
        if scope["method"] in SAFE or bears or access.is_csrf_token(shown, session or ""):
            return None
        detail = "the header X-CSRF-Token is missing or wrong; GET /api/session gives it"
        return JSONResponse({"detail": detail}, 403)

    async def _signed_in(self, headers: Headers, request: Request) -> Response:
        """Exchange a token for a cookie."""
        if int(headers.get("content-length", "0")) > BODY or "content-length" not in headers:
            return PlainTextResponse("too large\n", 413)
        form = urllib.parse.parse_qs((await request.body()).decode("latin-1"))
        if not self._access.is_token(form.get("token", [""])[0].strip()):
            await asyncio.sleep(WRONG_TOKEN_WAIT)
            return HTMLResponse(sign_in_page("This is not the token."), 401)
        answer = RedirectResponse("/", 303)
        answer.set_cookie(
            COOKIE,
            self._access.new_cookie(),
            max_age=LASTS,
            httponly=True,
            samesite="strict",
            secure=request.url.scheme == "https",
        )
        return answer


def _token_needed(headers: Headers, scope: Scope) -> Response:
    """Return the form to a person's browser, a line to a program."""
    if scope["method"] == "GET" and "text/html" in headers.get("accept", ""):
        return HTMLResponse(sign_in_page(), 401)
    text = "a token is needed: Authorization: Bearer TOKEN\n"
    return PlainTextResponse(text, 401, {"WWW-Authenticate": "Bearer"})


def _too_large(limit: int) -> str:
    return f"the body is larger than {limit} bytes"


def _bounded(receive: Receive, limit: int) -> Receive:
    """Return ``receive`` that refuses a body without a length as soon as it is larger than ``limit``."""
    taken = 0

    async def bounded() -> Message:
        nonlocal taken
        message = await receive()
        taken += len(message.get("body", b""))
        if taken > limit:
            raise HTTPException(413, _too_large(limit))
        return message

    return bounded


def _with_headers(send: Send) -> Send:
    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in HEADERS.items():
                headers.setdefault(name, value)
        await send(message)

    return sending
