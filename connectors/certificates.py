"""Makes certificates for plants that have no authority of their own.

Extensions are those of RFC 5280 for TLS, and of OPC UA Part 6, 6.2.2 for an application instance.
"""

from __future__ import annotations

import ipaddress
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta

from cryptography import x509
from cryptography.hazmat.primitives.asymmetric.rsa import RSAPrivateKey, generate_private_key
from cryptography.hazmat.primitives.hashes import SHA256
from cryptography.hazmat.primitives.serialization import (
    Encoding,
    NoEncryption,
    PrivateFormat,
    load_pem_private_key,
)
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

_USES = (ExtendedKeyUsageOID.CLIENT_AUTH, ExtendedKeyUsageOID.SERVER_AUTH)


@dataclass(frozen=True, slots=True)
class Identity:
    """A certificate and its private key."""

    certificate: x509.Certificate
    key: RSAPrivateKey

    @classmethod
    def of_pem(cls, certificate: bytes, key: bytes) -> Identity:
        """Read what ``pem`` and ``key_pem`` wrote; raises ValueError."""
        private = load_pem_private_key(key, None)
        if not isinstance(private, RSAPrivateKey):
            raise ValueError("expected an RSA key")  # noqa: TRY004 - a file's content, not a caller's type
        return cls(x509.load_pem_x509_certificate(certificate), private)

    def pem(self) -> bytes:
        """Return the certificate."""
        return self.certificate.public_bytes(Encoding.PEM)

    def der(self) -> bytes:
        """Return the certificate as OPC UA servers mostly take it."""
        return self.certificate.public_bytes(Encoding.DER)

    def key_pem(self) -> bytes:
        """Return the private key, not encrypted."""
        return self.key.private_bytes(Encoding.PEM, PrivateFormat.PKCS8, NoEncryption())


def authority(name: str, days: int) -> Identity:
    """Make an authority that signs others."""
    usage = _key_usage(key_cert_sign=True, crl_sign=True)
    basic = x509.BasicConstraints(ca=True, path_length=0)
    return _made(name, days, None, [(basic, True), (usage, True)])


def signed(name: str, hosts: Sequence[str], days: int, by: Identity) -> Identity:
    """Make a certificate for a client or server in TLS; ``hosts`` are names or IP addresses."""
    usage = _key_usage(digital_signature=True, key_encipherment=True)
    extensions = [(usage, True), (x509.ExtendedKeyUsage(_USES), False), (_alternatives(hosts), False)]
    return _made(name, days, by, [(x509.BasicConstraints(ca=False, path_length=None), True), *extensions])


def application(name: str, hosts: Sequence[str], uri: str, days: int) -> Identity:
    """Make a self-signed certificate for an OPC UA application with this application URI."""
    usage = _key_usage(
        digital_signature=True,
        content_commitment=True,
        key_encipherment=True,
        data_encipherment=True,
        key_cert_sign=True,
    )
    names = x509.SubjectAlternativeName([x509.UniformResourceIdentifier(uri), *_alternatives(hosts)])
    extensions = [(usage, True), (x509.ExtendedKeyUsage(_USES), False), (names, False)]
    return _made(name, days, None, [(x509.BasicConstraints(ca=False, path_length=None), True), *extensions])


def _made(
    name: str, days: int, by: Identity | None, extensions: Sequence[tuple[x509.ExtensionType, bool]]
) -> Identity:
    """Make a key, and a certificate signed ``by`` another, or by itself."""
    key = generate_private_key(public_exponent=65537, key_size=2048)
    subject = x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name[:64])])
    issuer, issuer_key = (subject, key) if by is None else (by.certificate.subject, by.key)
    now = datetime.now(UTC)
    builder = (
        x509.CertificateBuilder(subject_name=subject, issuer_name=issuer, public_key=key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - timedelta(days=1))  # clocks of a plant differ
        .not_valid_after(now + timedelta(days=days))
        .add_extension(x509.SubjectKeyIdentifier.from_public_key(key.public_key()), critical=False)
        .add_extension(
            x509.AuthorityKeyIdentifier.from_issuer_public_key(issuer_key.public_key()), critical=False
        )
    )
    for extension, critical in extensions:
        builder = builder.add_extension(extension, critical)
    return Identity(builder.sign(issuer_key, SHA256()), key)


def _alternatives(hosts: Sequence[str]) -> x509.SubjectAlternativeName:
    return x509.SubjectAlternativeName([_host(host) for host in hosts])


def _host(host: str) -> x509.GeneralName:
    try:
        return x509.IPAddress(ipaddress.ip_address(host))
    except ValueError:
        return x509.DNSName(host)


def _key_usage(**allowed: bool) -> x509.KeyUsage:
    uses = (
        "digital_signature",
        "content_commitment",
        "key_encipherment",
        "data_encipherment",
        "key_agreement",
        "key_cert_sign",
        "crl_sign",
        "encipher_only",
        "decipher_only",
    )
    return x509.KeyUsage(**{use: allowed.get(use, False) for use in uses})
