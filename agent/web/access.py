"""Who may do what: a token or the cookie it was exchanged for, and a CSRF token for what changes state."""

from __future__ import annotations

import hashlib
import hmac
import secrets
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie

COOKIE = "slipjump"
LASTS = 12 * 3600
"""A cookie is good for so long, s: a shift."""
LOOPBACK = frozenset({"127.0.0.1", "localhost", "[::1]"})
"""Names under which only this machine can be meant."""


@dataclass(frozen=True, slots=True)
class Access:
    """The rules of one server. Cookies outlive a restart as long as the token stays the same."""

    token: str | None = field(default=None, repr=False)
    """What a client must show; None: nothing."""
    hosts: frozenset[str] | None = LOOPBACK
    """Names by which clients may call this server, against DNS rebinding; None: any."""
    clock: Callable[[], float] = time.time
    """Gives the time, s UTC."""
    _secret: bytes = field(default_factory=lambda: secrets.token_bytes(32), repr=False)

    def knows_host(self, host: str) -> bool:
        """Whether the header ``Host`` names this server."""
        name = host.lower() if host.endswith("]") else host.lower().rpartition(":")[0] or host.lower()
        return self.hosts is None or name in self.hosts

    def is_token(self, shown: str) -> bool:
        """Whether ``shown`` is the token, compared in constant time."""
        return self.token is not None and hmac.compare_digest(shown.encode(), self.token.encode())

    def bears_token(self, authorization: str) -> bool:
        """Whether the header ``Authorization`` carries the token."""
        scheme, _, shown = authorization.partition(" ")
        return scheme.lower() == "bearer" and self.is_token(shown)

    def new_cookie(self) -> str:
        """Return the value of a cookie that stands for the token until it ends."""
        session = f"{int(self.clock()) + LASTS}.{secrets.token_urlsafe(12)}"
        return f"{session}.{self._sign('cookie', session)}"

    def session_of(self, cookies: str) -> str | None:
        """Return the session of a header ``Cookie``; None where it has none that is good."""
        try:
            morsel = SimpleCookie(cookies).get(COOKIE)
        except CookieError:
            return None
        session, _, signature = ("" if morsel is None else morsel.value).rpartition(".")
        if not hmac.compare_digest(signature.encode(), self._sign("cookie", session).encode()):
            return None
        end = session.partition(".")[0]
        return session if end.isdigit() and int(end) > self.clock() else None

    def csrf_token(self, session: str) -> str:
        """Return what a page must send with each request that changes state."""
        return self._sign("csrf", session)

    def is_csrf_token(self, shown: str, session: str) -> bool:
        """Whether ``shown`` is the CSRF token of a session."""
        return hmac.compare_digest(shown.encode(), self.csrf_token(session).encode())

    def _sign(self, use: str, text: str) -> str:
        key = self._secret if self.token is None else self.token.encode()
        return hmac.new(key, f"{use}:{text}".encode(), hashlib.sha256).hexdigest()
