"""Who the server is, who we are, and in plain words why the two do not come together."""

from __future__ import annotations

from datetime import UTC, datetime

from asyncua import Client, ua
from asyncua.crypto import security_policies
from asyncua.crypto.uacrypto import CertProperties, x509_from_der
from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_der_private_key,
    load_pem_private_key,
)
from cryptography.x509.verification import (
    Criticality,
    ExtensionPolicy,
    PolicyBuilder,
    Store,
    VerificationError,
)

from connectors.base import AccessDeniedError
from connectors.opcua.options import Login, OpcUaOptions, Security
from connectors.secret import Secret, content

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
    """Make sure who the server is and tell the client who we are, before it connects.

    Raises AccessDeniedError, and what asyncua raises where there is no server.
    """
    if options.security is not None:
        await _secure(client, options.security)
    if options.login is not None:
        await _log_in(client, options.login)


async def _secure(client: Client, security: Security) -> None:
    certificate = _certificate("security.certificate", security.certificate)
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
    client.application_uri = _uri(certificate, security.certificate)
    await client.set_security(
        policy,
        CertProperties(certificate.public_bytes(Encoding.DER), "der"),
        CertProperties(_key("security.key", security.key, security.key_password), "der"),
        server_certificate=CertProperties(server.public_bytes(Encoding.DER), "der"),
        mode=mode,
    )


async def _log_in(client: Client, login: Login) -> None:
    if login.user is not None and login.password is not None:
        client.set_user(login.user)
        client.set_password(login.password.read("login.password"))
    elif login.certificate is not None and login.key is not None:
        certificate = _certificate("login.certificate", login.certificate)
        await client.load_client_certificate(certificate.public_bytes(Encoding.DER), "der")
        await client.load_private_key(_key("login.key", login.key, login.key_password), extension="der")


def _same(server: x509.Certificate, path: str) -> None:
    expected = _certificate("security.server_certificate", path)
    if server != expected:
        raise AccessDeniedError(
            f"it shows another certificate (SHA-256 {server.fingerprint(SHA256()).hex()}) than "
            f"security.server_certificate {path}; if it was renewed, ask its owner and replace that file"
        )


def _signed(server: x509.Certificate, path: str, host: str) -> None:
    """Check signature, time and names; extensions differ too much between makers to insist on them."""
    try:
        authorities = x509.load_pem_x509_certificates(content("security.ca", path))
    except ValueError as error:
        raise AccessDeniedError(f"security.ca: {path} holds no certificates in PEM") from error
    builder = PolicyBuilder().store(Store(authorities)).time(datetime.now(UTC))
    lenient = ExtensionPolicy.permit_all()
    of_ca = lenient.require_present(x509.BasicConstraints, Criticality.AGNOSTIC, None)
    verifier = builder.extension_policies(ca_policy=of_ca, ee_policy=lenient).build_client_verifier()
    try:
        verifier.verify(server, [])
    except VerificationError as error:
        raise AccessDeniedError(f"its certificate is not accepted: {error}; check security.ca") from error
    if host not in _hosts(server):
        raise AccessDeniedError(
            f"its certificate is for {', '.join(_hosts(server)) or 'no host'} and not for {host}; "
            "check url, or name the certificate itself as security.server_certificate"
        )


def _names(certificate: x509.Certificate) -> x509.SubjectAlternativeName:
    try:
        return certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return x509.SubjectAlternativeName([])


def _hosts(certificate: x509.Certificate) -> list[str]:
    names = _names(certificate)
    hosts = names.get_values_for_type(x509.DNSName)
    return [host.lower() for host in hosts] + [str(ip) for ip in names.get_values_for_type(x509.IPAddress)]


def _uri(certificate: x509.Certificate, path: str) -> str:
    """Return the application URI, which servers compare with the one that the client tells."""
    uris = _names(certificate).get_values_for_type(x509.UniformResourceIdentifier)
    if not uris:
        raise AccessDeniedError(
            f"security.certificate: {path} has no application URI in its alternative names"
        )
    return uris[0]


def _certificate(option: str, path: str) -> x509.Certificate:
    data = content(option, path)
    try:
        return x509.load_pem_x509_certificate(data) if _is_pem(data) else x509.load_der_x509_certificate(data)
    except ValueError as error:
        raise AccessDeniedError(f"{option}: {path} holds no certificate") from error


def _key(option: str, path: str, secret: Secret | None) -> bytes:
    """Return a private key in DER and in the open, as asyncua takes it."""
    data = content(option, path)
    password = None if secret is None else secret.read(f"{option}_password").encode()
    try:
        key = load_pem_private_key(data, password) if _is_pem(data) else load_der_private_key(data, password)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise AccessDeniedError(
            f"{option}: {path} holds no private key that {option}_password opens"
        ) from error
    return key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())


def _is_pem(data: bytes) -> bool:
    return data.lstrip().startswith(b"-----BEGIN")
