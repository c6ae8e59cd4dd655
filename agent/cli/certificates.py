"""``slipjump certificates``: keys and certificates for encrypted connections."""

from __future__ import annotations

import os
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from connectors.base import ConfigError

if TYPE_CHECKING:
    from connectors.certificates import Identity

ONLY_THE_OWNER = 0o600


def certificates(
    *,
    out: Annotated[Path, typer.Option(metavar="DIR", show_default=False, help="Where to write them.")],
    host: Annotated[str, typer.Option(show_default=False, help="Name of the machine that slipjump runs on.")],
    server: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="A broker or device that needs a certificate, too; any number."),
    ] = None,
    days: Annotated[int, typer.Option(min=1, max=36500, help="How long they are valid.")] = 1825,
) -> None:
    """Make certificates for TLS and OPC UA, and say what to do with them. What exists is kept."""
    from connectors.certificates import application, signed

    servers, agent = server or [], f"slipjump on {host}"
    out.mkdir(parents=True, exist_ok=True, mode=0o700)
    try:
        authority = _authority(out, host, days)
        _make(out, "client", partial(signed, agent, [host], days, authority))
        _make(out, "opcua", partial(application, agent, [host], f"urn:{host}:slipjump", days))
        for name in servers:
            _make(out, f"server-{name}", partial(signed, name, [name], days, authority))
    except ValueError as error:
        raise ConfigError([f"{out}: no certificate was made: {error}"]) from error
    for line in _next_steps(out, servers):
        typer.echo(line)


def _authority(out: Path, host: str, days: int) -> Identity:
    """Return the authority that is in the folder, made if there was none."""
    from connectors.certificates import Identity, authority

    _make(out, "ca", partial(authority, f"slipjump authority of {host}", days))
    return Identity.of_pem((out / "ca.pem").read_bytes(), (out / "ca-key.pem").read_bytes())


def _make(out: Path, stem: str, make: Callable[[], Identity]) -> None:
    """Write a certificate in PEM and DER and its key, unless they are there."""
    if (out / f"{stem}.pem").exists():
        return
    identity = make()
    files = {"-key.pem": identity.key_pem(), ".der": identity.der(), ".pem": identity.pem()}
    for end, data in files.items():
        path = out / f"{stem}{end}"
        try:
            handle = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, ONLY_THE_OWNER)
        except OSError as error:
            raise ConfigError([f"{path}: cannot be written: {error.strerror}"]) from error
        with os.fdopen(handle, "wb") as file:
            file.write(data)


def _next_steps(out: Path, servers: list[str]) -> list[str]:
    return [
        f"{out}/ca-key.pem signs the others: keep it away from the plant.",
        "",
        "MQTT and Modbus: give ca.pem to the broker or device as the authority of its clients, and write",
        f"    tls: {{ca: {out}/ca.pem, certificate: {out}/client.pem, key: {out}/client-key.pem}}",
        "  (ca is the authority of the server's certificate: this one only if it signed that, too)",
        "",
        f"OPC UA: put {out}/opcua.der on the server's list of trusted clients, save the server's",
        "certificate to a file, and write",
        f"    security: {{certificate: {out}/opcua.pem, key: {out}/opcua-key.pem, server_certificate: FILE}}",
        "",
        *(f"{name}: give it server-{name}.pem, server-{name}-key.pem and ca.pem." for name in servers),
        "Then: slipjump check CONFIG.yaml --connect",
    ]
