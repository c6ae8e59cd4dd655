"""Who may come in, and what he may do."""

from __future__ import annotations

import hmac
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from asyncua import ua
from asyncua.common.utils import ServiceError
from asyncua.crypto.permission_rules import User, UserRole
from asyncua.server.user_managers import UserManager
from cryptography import x509
from cryptography.hazmat.primitives.serialization import Encoding

from connectors.base import AccessDeniedError
from connectors.opcua.credentials import certificate_in, signed_by
from connectors.opcua_server.options import OpcUaServerOptions, ServerSecurity, ServerUser

_LOG = logging.getLogger(__name__)


@dataclass
class KnownUser(User):  # type: ignore[misc]
    """Whom a session belongs to."""

    may_order: bool = False
    """Whether he may acknowledge, shelve and take out of service."""


class CertificateRights(UserManager):  # type: ignore[misc]
    """Decides each time a session begins, by the certificate of its channel.

    All else in asyncua 2.1 that looks like a check can be gone around: a client may use an unprotected
    channel although none is offered, and leave out the certificate that ``certificate_validator`` judges.
    """

    def __init__(self, options: OpcUaServerOptions) -> None:
        """Read what the options name; raises AccessDeniedError."""
        self.refused = 0
        """Sessions that were not let in."""
        self._options = options
        self._clients = _clients(options.security)
        self._logged = ""
        for name, user in options.users.items():
            user.password.read(f"users.{name}.password")

    def get_user(
        self,
        iserver: Any,  # noqa: ANN401, ARG002 - asyncua's own
        username: str | None = None,
        password: str | None = None,
        certificate: bytes | None = None,
    ) -> KnownUser | None:
        """Return whose session it is, None where the user is not let in; raises ServiceError."""
        if self._options.security is not None and not self._knows(certificate, self._options.security):
            self._refuse("a client whose certificate is not trusted")
            raise ServiceError(ua.StatusCodes.BadCertificateUntrusted)
        if username is None:
            if self._options.anonymous != "refused":
                return KnownUser(UserRole.User, may_order=self._options.anonymous == "order")
            self._refuse("an anonymous client")
            return None
        user = self._options.users.get(username)
        if user is None or not _is_password_of(user, username, password):
            self._refuse(f"user {username[:40]!r}")
            return None
        return KnownUser(UserRole.User, username, may_order=user.may == "order")

    def _knows(self, shown: bytes | None, security: ServerSecurity) -> bool:
        if not shown:
            return False
        if shown in self._clients:
            return True
        if security.ca is None:
            return False
        try:
            signed_by("security.ca", security.ca, x509.load_der_x509_certificate(shown))
        except (AccessDeniedError, ValueError):
            return False
        return True

    def _refuse(self, whom: str) -> None:
        """Count it; logged once, until it is another."""
        self.refused += 1
        if whom != self._logged:
            self._logged = whom
            _LOG.warning("OPC UA server on port %d: %s was not let in", self._options.port, whom)


def _clients(security: ServerSecurity | None) -> Sequence[bytes]:
    paths = () if security is None else security.clients
    return [certificate_in("security.clients", path).public_bytes(Encoding.DER) for path in paths]


def _is_password_of(user: ServerUser, name: str, password: str | None) -> bool:
    """Compare; the password is read anew, so that it can be changed without a restart."""
    try:
        expected = user.password.read(f"users.{name}.password")
    except AccessDeniedError as error:
        _LOG.error("OPC UA server: %s", error)
        return False
    return hmac.compare_digest(expected.encode(), (password or "").encode())
