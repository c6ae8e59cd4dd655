"""Who the server is, who we are, and in plain words why the two do not come together."""

from __future__ import annotations

from asyncua import Client, ua
from asyncua.crypto import security_policies
from asyncua.crypto.uacrypto import CertProperties, x509_from_der
from cryptography import x509
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import Encoding

from connectors.base import AccessDeniedError
from connectors.opcua.credentials import application_uri, certificate_in, hosts_of, private_key_in, signed_by
from connectors.opcua.options import Login, OpcUaOptions, Security

_DENIALS = {
    "it does not let this user in; check login": {
        ua.StatusCodes.BadUserAccessDenied,
        ua.StatusCodes.BadIdentityTokenInvalid,
        ua.StatusCodes.BadIdentityTokenRejected,
        ua.StatusCodes.BadUserSignatureInvalid,
    },
    "it does not accept this client; put security.certificate on its list of trusted clients": {
        ua.StatusCodes.BadSecurityChecksFailed,
        ua.StatusCodes.BadCertificateInvalid,
        ua.StatusCodes.BadCertificateUntrusted,
        ua.StatusCodes.BadCertificateTimeInvalid,
        ua.StatusCodes.BadCertificateUriInvalid,
        ua.StatusCodes.BadCertificateHostNameInvalid,
        ua.StatusCodes.BadCertificateUseNotAllowed,
        ua.StatusCodes.BadCertificateRevoked,
        ua.StatusCodes.BadCertificateChainIncomplete,
        ua.StatusCodes.BadApplicationSignatureInvalid,
    },
    "it does not take connections of this kind; check security": {
        ua.StatusCodes.BadSecurityPolicyRejected,
        ua.StatusCodes.BadSecurityModeRejected,
    },
}
"""Remedy -> what a server says where it helps (OPC UA Part 4, 7.39.2)."""


def refusal(error: Exception) -> str | None:
    """Return what a server means by an error while one connects, and what to do; None: it is no refusal."""
    code = getattr(error, "code", None)
    for remedy, codes in _DENIALS.items():
        if code in codes:
            return f"{remedy} ({ua.StatusCode(code).name})"
    return None


async def identify(client: Client, options: OpcUaOptions) -> None:
    """Make sure who the server is and give the client our identity, before it connects.

    Raises AccessDeniedError, and what asyncua raises where there is no server.
    """
    if options.security is not None:
        await _secure(client, options.security)
    if options.login is not None:
        await _log_in(client, options.login)


async def _secure(client: Client, security: Security) -> None:
    certificate = certificate_in("security.certificate", security.certificate)
    policy = getattr(security_policies, f"SecurityPolicy{security.policy}")
    mode = ua.MessageSecurityMode.SignAndEncrypt
    # anybody may answer this question, which goes out unprotected: only the certificate is believed
    endpoints = await client.connect_and_get_server_endpoints()
    shown = [
        e.ServerCertificate for e in endpoints if (e.SecurityMode, e.SecurityPolicyUri) == (mode, policy.URI)
    ]
    server = x509_from_der(shown[0]) if shown else None
    if server is None:
        offered = {f"{e.SecurityPolicyUri.rpartition('#')[2]} {e.SecurityMode.name}" for e in endpoints}
        raise AccessDeniedError(
            f"it offers no {security.policy} SignAndEncrypt but {', '.join(sorted(offered))}; "
            "check security.policy and the server's endpoints"
        )
    if security.server_certificate is not None:
        _same(server, security.server_certificate)
    if security.ca is not None:
        _signed(server, security.ca, str(client.server_url.hostname))
    client.application_uri = application_uri("security.certificate", security.certificate, certificate)
    await client.set_security(
        policy,
        CertProperties(certificate.public_bytes(Encoding.DER), "der"),
        CertProperties(private_key_in("security.key", security.key, security.key_password), "der"),
        server_certificate=CertProperties(server.public_bytes(Encoding.DER), "der"),
        mode=mode,
    )


async def _log_in(client: Client, login: Login) -> None:
    if login.user is not None and login.password is not None:
        client.set_user(login.user)
        client.set_password(login.password.read("login.password"))
    elif login.certificate is not None and login.key is not None:
        certificate = certificate_in("login.certificate", login.certificate)
        await client.load_client_certificate(certificate.public_bytes(Encoding.DER), "der")
        await client.load_private_key(
            private_key_in("login.key", login.key, login.key_password), extension="der"
        )


def _same(server: x509.Certificate, path: str) -> None:
    expected = certificate_in("security.server_certificate", path)
    if server != expected:
        raise AccessDeniedError(
            f"it shows another certificate (SHA-256 {server.fingerprint(SHA256()).hex()}) than "
            f"security.server_certificate {path}; if it was renewed, replace that file"
        )


def _signed(server: x509.Certificate, path: str, host: str) -> None:
    signed_by("security.ca", path, server)
    hosts = hosts_of(server)
    if host not in hosts:
        raise AccessDeniedError(
            f"its certificate is for {', '.join(hosts) or 'no host'} and not for {host}; "
            "check url, or name the certificate itself as security.server_certificate"
        )
