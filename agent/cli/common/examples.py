"""One or two examples for the end of each command's help."""

from __future__ import annotations

from collections.abc import Mapping

EXAMPLES: Mapping[str, tuple[str, ...]] = {
    "demo": ("slipjump demo  (six simulated loops on three buses, and their alarms)",),
    "diagnose": (
        "slipjump diagnose FIC101.csv --plot pictures  (does it stick, how much; with pictures)",
        "slipjump diagnose plant/ --report plant.html  (all valves, the most urgent first; or .pdf, .csv)",
        "slipjump diagnose export.csv --loop FIC101 --delay 17s  (one loop of many, its dead time known)",
    ),
    "survey": (
        "slipjump survey archive/ -o survey  (all files in all folders; a table and a ranking)",
        "slipjump survey export.csv --cluster tcp://host:8786 -o survey  (on the machines of a dask cluster)",
    ),
    "compare": (
        "slipjump compare FIC101.csv  (on a terminal: a conversation, step by step; the session is kept)",
        "slipjump compare FIC101.csv --auto  (add the effects that the record confirms)",
        "slipjump compare FIC101.csv --add deadband --report FIC101.html  (one effect, and a page)",
    ),
    "workbench": (
        "slipjump workbench FIC101.csv  (in the browser: see where the model fails, tick the missing effect)",
        "slipjump workbench --no-browser --port 8080  (prints the address; recordings are uploaded there)",
    ),
    "import": (
        "slipjump import export.csv --preview  (what was understood)",
        "slipjump import export.csv -o export.yaml  (the same as a file; correct it, give it to --mapping)",
    ),
    "replay": ("slipjump replay FIC101.csv --bus mqtt  (over a broker to the agent: is the alarm seen?)",),
    "serve": (
        "slipjump serve --list  (scenarios that ship)",
        "slipjump serve fic101_stick_slip --bus mqtt --config plant.yaml  (then: slipjump run plant.yaml)",
    ),
    "run": ("slipjump run plant.yaml --log-format json  (until SIGTERM or Ctrl-C)",),
    "browse": (
        "slipjump browse opc.tcp://dcs:4840 -o plant.yaml  (find the loops, write a configuration)",
        "slipjump browse mqtt://broker:1883 -o plant.yaml  (the same of what is published there)",
    ),
    "check": (
        "slipjump check plant.yaml  (what run would do, or every fault with its line)",
        "slipjump check plant.yaml --connect  (open each connection, read each tag)",
    ),
    "registers": ("slipjump registers plant.yaml --csv  (for the configuration of the control system)",),
    "history": ("slipjump history --config plant.yaml --loop FIC101  (what was found of one loop)",),
    "simulate": ("slipjump simulate fic101_stick_slip -o FIC101.csv  (a recording whose truth is known)",),
    "certificates": ("slipjump certificates --out tls --host agent.plant.example  (for TLS and OPC UA)",),
    "alarms": (
        "slipjump alarms list --config plant.yaml  (the alarm of each loop)",
        "slipjump alarms shelve FIC101 --hours 8 --config plant.yaml  (suppress it for a shift)",
    ),
}
"""Command -> examples, each with what it is for in brackets."""


def epilog(command: str) -> str | None:
    """Return the end of a command's help; None where it has no example."""
    lines = EXAMPLES.get(command)
    return None if lines is None else "\n\n".join(["Examples:", *lines])
