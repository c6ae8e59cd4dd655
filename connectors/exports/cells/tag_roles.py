"""What a column or tag is of: ``FIC101.PV``, ``FIC-101/PID1/OUT.CV`` or ``PV (t/h)``."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

ROLES = {
    "pv": "pv meas measurement processvalue processvariable pvin actualvalue istwert messwert measuredvalue "
    "mesure",
    "op": "op out co output lmn controlleroutput controloutput outputvalue cout pidout stellwert stellgröße "
    "stellgroesse sortie",
    "sp": "sp sv setpoint spt setpointvalue sollwert wsp lsp setvalue",
    "mv": "mv valveposition position pos stem zt feedback travel readback valve",
    "mode": "mode md actualmode modeactual betriebsart automan auto_man",
    "quality": "quality status qual sts q statuscode opcquality confidence dataintegrity validity",
}
"""Role -> words for it, lower case, without blanks and underscores."""
ROLE = {word.replace("_", "").casefold(): role for role, words in ROLES.items() for word in words.split()}
VALUES = frozenset(
    {"cv", "value", "val", "fcv", "readvalue", "currentvalue", "act", "actual", "presentvalue", "v"}
)
"""Words behind a role that say no more than that its value is meant."""
BLOCK = re.compile(r"(?:PIDA?|DACA|DATAACQA?|AI|AO|FB|BLK|CTRL|LOOP|CTL)_?\d*", re.IGNORECASE)
"""Function blocks between tag and role; Experion has PV in DACA and OP in PIDA."""
SERVER = re.compile(r"^(?:\\\\[^\\]+\\|\[[^\]]*\]|[A-Za-z]\w*://[^/]+/)")
"""``\\\\PISRV\\``, ``[default]`` before a tag."""
SERIES = re.compile(r"(?P<name>[^{}]*)\{(?P<labels>[^{}]*)\}")
"""A series with its labels, as Prometheus and Grafana write it: ``PV {loop="FIC101", host="a"}``."""
LABEL = re.compile(r'\s*([\w.]+)\s*[=:]\s*(?:"([^"]*)"|([^,"]*))')
LOOP_LABELS = ("loop", "controller", "tag", "device", "asset", "equipment", "name")
"""Labels whose value is a loop's name rather than that of others, such as a host, the surest first."""
LONGEST_ROLE = 2
"""Words of a role: Controller Output."""
UNIT = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
TIME_ENDING = re.compile(
    r"(?<=\w{4})[_ \-]?(s|sec|seconds|ms|us|µs|ns|min|minutes|utc|local)$", re.IGNORECASE
)
"""Unit or zone behind a word for time; behind a short one it is part of another name, such as ``T_s``."""
TIME_WORDS = frozenset(
    [
        "time",
        "timestamp",
        "date",
        "datetime",
        "t",
        "zeit",
        "zeitstempel",
        "datum",
        "uhrzeit",
        "heure",
        "fecha",
        "hora",
        "tijd",
        "ts",
        "localtime",
        "utctime",
        "sampletime",
        "datumuhrzeit",
        "date/time",
        "elapsed",
        "elapsedtime",
        "epoch",
        "eventtime",
        "readtime",
        "timestring",
        "tstamp",
        "unixtime",
    ]
)
TAG_WORDS = frozenset(
    [
        "tag",
        "tagname",
        "name",
        "point",
        "pointname",
        "item",
        "itemid",
        "itemname",
        "variable",
        "parameter",
        "sensor",
        "tagid",
        "path",
        "browsepath",
        "tagpath",
        "varname",
        "metric",
        "series",
        "topic",
    ]
)
VALUE_WORDS = frozenset(
    [
        "value",
        "val",
        "reading",
        "wert",
        "valeur",
        "vvalue",
        "rawvalue",
        "tagvalue",
        "pointvalue",
        "numericvalue",
        "varvalue",
        "floatvalue",
        "avg",
        "average",
    ]
)


@dataclass(frozen=True, slots=True)
class TagRole:
    """A tag taken apart."""

    loop: str
    """Empty where the name is a role alone."""
    role: str
    """pv, op, sp, mv or mode."""
    of_quality: bool = False
    """Whether the column holds the quality of that role, not its value."""
    word: str = ""
    """The word for the role, lower case."""


def plain(name: str) -> str:
    """Return a name in lower case without unit, blanks, underscores and hyphens."""
    return re.sub(r"[\s_\-%]+", "", UNIT.sub("", name)).casefold()


def is_time(name: str) -> bool:
    """Whether a name is a word for time, alone or with a unit or a zone behind it: ``timestamp_us``."""
    return plain(name) in TIME_WORDS or plain(TIME_ENDING.sub("", name)) in TIME_WORDS


def unit_of(name: str) -> str:
    """Return the unit in brackets behind a name, or behind a word for time; else an empty text."""
    found = UNIT.search(name) or (TIME_ENDING.search(name) if is_time(name) else None)
    return found[1] if found else ""


@lru_cache(maxsize=100_000)
def tag_role(name: str) -> TagRole | None:
    """Return loop and role of a tag, or None where it has no word for a role."""
    series = SERIES.fullmatch(name.strip())
    if series is not None:
        return _of_series(series["name"].strip(), _labels(series["labels"]))
    bare = SERVER.sub("", UNIT.sub("", name)).strip()
    parts = [part for part in re.split(r"[./\\:|#]+", bare) if part]
    quality = False
    while parts and (plain(parts[-1]) in VALUES or (ROLE.get(plain(parts[-1])) == "quality")):
        quality = quality or ROLE.get(plain(parts[-1])) == "quality"
        parts.pop()
    if not parts:
        return None
    role = ROLE.get(plain(parts[-1]))
    if role is None or (role == "quality"):
        split = _within(parts[-1])
        if split is None:
            return None
        head, word, of_quality = split
        parts[-1:] = [head] if head else []
        quality = quality or of_quality
    else:
        word = plain(parts.pop())
    while len(parts) > 1 and BLOCK.fullmatch(parts[-1]):
        parts.pop()
    return TagRole("/".join(part.strip() for part in parts), ROLE[word], quality, word)


def _labels(text: str) -> dict[str, str]:
    return {key.casefold(): (quoted or plain_).strip() for key, quoted, plain_ in LABEL.findall(text)}


def _of_series(name: str, labels: Mapping[str, str]) -> TagRole | None:
    """Return loop and role of a series: of a label that is a whole tag, else of its name and its labels."""
    found = {text: role for text in (*labels.values(), name) if (role := tag_role(text)) is not None}
    whole = next((found[text] for text in labels.values() if text in found and found[text].loop), None)
    if whole is not None or not found:
        return whole
    role = next(iter(found.values()))
    others = {key: text for key, text in labels.items() if text not in found}
    named = [others[key] for key in LOOP_LABELS if key in others]
    return replace(role, loop=named[0] if named else "/".join(others.values()) or role.loop)


def _within(part: str) -> tuple[str, str, bool] | None:
    """Return loop, word of the role and whether quality is meant, of ``FIC101_PV`` or ``PV FIC101``.

    The first mark that has a role at its end separates it: ``20-FIC-101 PV`` is the PV of ``20-FIC-101``.
    """
    for marks in (r"\s", "_", "-", r"[\s_-]"):
        words = [word for word in re.split(marks + "+", part) if word]
        found = _at_an_end(words, marks if len(marks) == 1 else "_")
        if found is not None:
            return found
    return None


def _at_an_end(words: Sequence[str], mark: str) -> tuple[str, str, bool] | None:
    """Return as ``_within``, of words; the role may have several, such as ``Controller Output``."""
    quality = len(words) > 1 and ROLE.get(plain(words[-1])) == "quality"
    if quality and len(words) == 2 and _is_value(words[0]):
        return "", plain(words[0]), True  # PV Status behind the loop of a path
    shorter = words[:-1] if len(words) > 2 and (quality or plain(words[-1]) in VALUES) else None
    for some in (words, shorter) if shorter is not None and not quality else (shorter or words,):
        for count in range(min(LONGEST_ROLE, len(some) - 1), 0, -1):
            for ending, rest in ((some[-count:], some[:-count]), (some[:count], some[count:])):
                if _is_value("".join(ending)):
                    return "_".join(mark.join(rest).split()), plain("".join(ending)), quality
    return None


def _is_value(word: str) -> bool:
    return ROLE.get(plain(word), "quality") != "quality"
