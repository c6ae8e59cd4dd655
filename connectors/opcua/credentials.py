"""Certificates and keys in files, for both ends of a connection."""

from __future__ import annotations

from datetime import UTC, datetime

from cryptography import x509
from cryptography.exceptions import UnsupportedAlgorithm
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
from connectors.secret import Secret, content


def certificate_in(option: str, path: str) -> x509.Certificate:
    """Return the certificate of a file, PEM or DER; raises AccessDeniedError with option and path."""
    data = content(option, path)
    try:
        return x509.load_pem_x509_certificate(data) if _is_pem(data) else x509.load_der_x509_certificate(data)
    except ValueError as error:
        raise AccessDeniedError(f"{option}: {path} holds no certificate") from error


def private_key_in(option: str, path: str, secret: Secret | None) -> bytes:
    """Return a private key in DER and in the open, as asyncua takes it; raises AccessDeniedError."""
    data = content(option, path)
    password = None if secret is None else secret.read(f"{option}_password").encode()
    try:
        key = load_pem_private_key(data, password) if _is_pem(data) else load_der_private_key(data, password)
    except (ValueError, TypeError, UnsupportedAlgorithm) as error:
        raise AccessDeniedError(
            f"{option}: {path} holds no private key that {option}_password opens"
        ) from error
    return key.private_bytes(Encoding.DER, PrivateFormat.PKCS8, NoEncryption())


def application_uri(option: str, path: str, certificate: x509.Certificate) -> str:
    """Return the application URI, which the other side compares with the one that it receives."""
    uris = _names(certificate).get_values_for_type(x509.UniformResourceIdentifier)
    if not uris:
        raise AccessDeniedError(f"{option}: {path} has no application URI in its alternative names")
    return uris[0]


def hosts_of(certificate: x509.Certificate) -> list[str]:
    """Return the hosts that a certificate is for."""
    names = _names(certificate)
    hosts = names.get_values_for_type(x509.DNSName)
    return [host.lower() for host in hosts] + [str(ip) for ip in names.get_values_for_type(x509.IPAddress)]


def signed_by(option: str, path: str, certificate: x509.Certificate) -> None:
    """Check signature and time; extensions differ too much between makers to insist on them.

    Raises AccessDeniedError where none of the authorities of the file signed it.
    """
    try:
        authorities = x509.load_pem_x509_certificates(content(option, path))
    except ValueError as error:
        raise AccessDeniedError(f"{option}: {path} holds no certificates in PEM") from error
    builder = PolicyBuilder().store(Store(authorities)).time(datetime.now(UTC))
    lenient = ExtensionPolicy.permit_all()
    of_ca = lenient.require_present(x509.BasicConstraints, Criticality.AGNOSTIC, None)
    verifier = builder.extension_policies(ca_policy=of_ca, ee_policy=lenient).build_client_verifier()
    try:
        verifier.verify(certificate, [])
    except VerificationError as error:
        raise AccessDeniedError(f"its certificate is not accepted: {error}; check {option}") from error


def _names(certificate: x509.Certificate) -> x509.SubjectAlternativeName:
    try:
        return certificate.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
    except x509.ExtensionNotFound:
        return x509.SubjectAlternativeName([])


def _is_pem(data: bytes) -> bool:
    return data.lstrip().startswith(b"-----BEGIN")
