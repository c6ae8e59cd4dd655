# ruff: noqa: PLR0124, FBT002, PLC0415, SIM905 - NaN, flags of writers, optional libraries, lists of words
"""How exports are written: tables of one truth in each layout, as text or bytes."""

import io
import zipfile
from dataclasses import dataclass, field
from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import numpy as np

from tests.exports.truth import LOOPS, TIME, N

BERLIN = ZoneInfo("Europe/Berlin")


MONTHS = "Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec".split()


MONATE = "Jan Feb Mär Apr Mai Jun Jul Aug Sep Okt Nov Dez".split()


@dataclass(frozen=True)
class Case:
    """One file of the corpus."""

    name: str
    content: bytes
    loops: tuple
    """Loops that must be read."""
    time: np.ndarray | None = None
    """Times that must be read, s UTC; None: those of the truth."""
    gaps: bool = False
    """Whether PV has the gaps of the truth."""
    options: dict = field(default_factory=dict)
    """What a user states from the beginning (no file needs it but those without a time column)."""
    settles: dict = field(default_factory=dict)
    """Options without which the file is refused, and with which it is read."""
    names_option: str = ""
    """What the message of the refusal names."""
    single: bool = False
    """Whether the loop is named by the file, not by its columns."""
    sp: bool = False


def stamps(form, zone=UTC, moments=TIME):
    return [form(datetime.fromtimestamp(each, zone)) for each in moments]


def strf(pattern):
    return lambda moment: moment.strftime(pattern)


def iso(moment):
    return moment.strftime("%Y-%m-%dT%H:%M:%S")


def table(names, columns, sep=",", end="\n", before="", units=None):
    rows = [sep.join(names)]
    if units:
        rows.append(sep.join(units))
    rows += [sep.join(cells) for cells in zip(*columns, strict=True)]
    return (before + end.join(rows) + end).encode()


def num(values, form="{:.2f}", gap=""):
    return [gap if value != value else form.format(value) for value in values]


def comma(values, form="{:.2f}"):
    return [cell.replace(".", ",") for cell in num(values, form)]


def plain(time, loop=LOOPS[0], names=("time", "OP", "PV"), numbers=num, **more):
    return table(names, [time, numbers(loop.op), numbers(loop.pv)], **more)


def wide(time, form="{loop}.{role}", loops=LOOPS, roles=("PV", "OP"), first="Timestamp", numbers=num, **more):
    names, columns = [first], [time]
    for loop in loops:
        for role in roles:
            names.append(form.format(loop=loop.name, role=role))
            kind = (
                role.lower()
                if role.lower() in {"pv", "op", "sp"}
                else {"OUT": "op", "SV": "sp", "MV": "op", "CO": "op"}[role]
            )
            columns.append(numbers(getattr(loop, kind)))
    return table(names, columns, **more)


def long(
    time,
    form="{loop}.{role}",
    header=("tag", "time", "value", "quality"),
    quality="Good",
    by_tag=True,
    bad="Bad",
    **more,
):
    rows = []
    for loop in LOOPS:
        for role in ("PV", "OP"):
            values = loop.pv_with_gaps if role == "PV" else loop.op
            for k, value in enumerate(values):
                lost = value != value
                cells = (
                    form.format(loop=loop.name, role=role),
                    time[k],
                    "" if lost else f"{value:.2f}",
                    bad if lost else quality,
                )
                rows.append((k, cells))
    if not by_tag:
        rows.sort(key=lambda each: each[0])
    columns = list(zip(*(cells for _, cells in rows), strict=True))[: len(header)]
    return table(header, columns, **more)


def interleaved(rate=3):
    """A time column for each tag; OP is stored only when it has changed by much, so it is held."""
    loop = LOOPS[0]
    kept = [k for k in range(N) if k % rate == 0]
    rows = [
        "FIC101.PV time,FIC101.PV,FIC101.OP time,FIC101.OP".replace("FIC101.PV time", "Timestamp").replace(
            "FIC101.OP time", "Timestamp"
        )
    ]
    for k in range(N):
        left = f"{iso(datetime.fromtimestamp(TIME[k], UTC))},{loop.pv[k]:.2f}"
        right = (
            f"{iso(datetime.fromtimestamp(TIME[kept[k]], UTC))},{loop.op[kept[k]]:.2f}"
            if k < len(kept)
            else ","
        )
        rows.append(f"{left},{right}")
    held = loop.op[(np.arange(N) // rate) * rate]
    return ("\n".join(rows) + "\n").encode(), held


def parquet(kind):
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = {"FIC101.PV": LOOPS[0].pv, "FIC101.OP": LOOPS[0].op}
    if kind == "zone":
        times = pa.array((TIME * 1e6).astype("int64"), pa.timestamp("us", tz="UTC"))
    elif kind == "ms":
        times = pa.array((TIME * 1e3).astype("int64"))
    else:
        times = pa.array((TIME * 1e9).astype("int64"), pa.timestamp("ns"))
    target = io.BytesIO()
    pq.write_table(pa.table({"ts": times, **columns}), target)
    return target.getvalue()


def zipped(content=b"", **members):
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, each in (members or {"export.csv": content}).items():
            archive.writestr(name, each)
    return target.getvalue()


def newest_first(content):
    head, *rows = content.decode().splitlines()
    return "\n".join([head, *reversed(rows), ""]).encode()


def autumn():
    """Local times of Berlin over the end of summer time, when one hour comes twice."""
    first = datetime(2026, 10, 25, 0, 30, tzinfo=UTC).timestamp()
    moments = first + 15.0 * np.arange(N)
    return moments, stamps(strf("%d.%m.%Y %H:%M:%S"), BERLIN, moments)


def two_lines(time):
    loop, other = LOOPS[:2]
    before = ",FIC101,,PIC202,\n"
    return table(
        ("time", "PV", "OP", "PV", "OP"),
        [time, num(loop.pv), num(loop.op), num(other.pv), num(other.op)],
        before=before,
    )


def with_quality(time):
    loop = LOOPS[0]
    quality = ["192" if value == value else "24" for value in loop.pv_with_gaps]
    return table(
        ("time", "FIC101.PV", "FIC101.PV.Quality", "FIC101.OP"), [time, num(loop.pv), quality, num(loop.op)]
    )


def one_bad_row(time):
    rows = plain(time).decode().splitlines()
    rows.insert(100, "*** gateway restarted ***")
    rows.append("End of report")
    return "\n".join([*rows, ""]).encode()


def fixed_width(time):
    loop = LOOPS[0]
    rows = [f"{time[k]}  {loop.op[k]:9.2f}  {loop.pv[k]:9.2f}" for k in range(N)]
    return ("time                        OP         PV\n" + "\n".join(rows) + "\n").encode()


def header_repeated(time):
    head, *rows = plain(time).decode().splitlines()
    return "\n".join([head, *rows[:100], head, *rows[100:], ""]).encode()


def error_numbers(time):
    loop = LOOPS[0]
    lost = iter(("[-11059] No Good Data For Calculation", "#VALUE!", "#N/A N/A"))
    pv = [next(lost) if value != value else f"{value:.2f}" for value in loop.pv_with_gaps]
    return table(("time", "FIC101.PV", "FIC101.OP"), [time, pv, num(loop.op)])


def status_columns():
    """Date and time in two columns, a status behind each value: trends of Experion."""
    loop = LOOPS[0]
    status = ["Bad" if value != value else "Good" for value in loop.pv_with_gaps]
    return table(
        (
            "Date",
            "Time",
            "FIC101.PIDA.PV",
            "FIC101.PIDA.PV Status",
            "FIC101.PIDA.OP",
            "FIC101.PIDA.OP Status",
        ),
        [
            stamps(strf("%m/%d/%Y")),
            stamps(strf("%I:%M:%S %p")),
            num(loop.pv),
            status,
            num(loop.op),
            ["Good"] * N,
        ],
        before="Honeywell Experion PKS\nReport: Trend\n\n",
    )


def experion(time):
    """PV from the block of the measurement, OP from that of the controller."""
    loop = LOOPS[0]
    names = ("Time", "FIC101.DACA.PV", "FIC101.PIDA.OP", "FIC101.PIDA.MODE")
    return table(names, [time, num(loop.pv), num(loop.op), ["AUTO"] * N], units=("", "t/h", "%", ""))


def wincc():
    """A row a value, days of 1899 times a million beside the date."""
    loop = LOOPS[0]
    rows = ['"VarName";"TimeString";"VarValue";"Validity";"Time_ms"']
    for k, moment in enumerate(stamps(strf("%d.%m.%Y %H:%M:%S"))):
        days = comma([(TIME[k] / 86400 + 25569) * 1e6], "{:.4f}")[0]
        for role, values in (("PV", loop.pv_with_gaps), ("LMN", loop.op)):
            valid = int(values[k] == values[k])
            value = comma([values[k]])[0] or "0"
            rows.append(f'"FIC101_{role}";"{moment}";{value};{valid};{days}')
    return ("\r\n".join(rows) + "\r\n").encode()


def words_behind_tags(time):
    loop = LOOPS[0]
    names = ("Timestamp", "FIC101 Process Value", "FIC101 Controller Output")
    return table(names, [time, num(loop.pv), num(loop.op)])


def signs_and_status_names(time):
    lost = iter(("BadWaitingForInitialData", "---.--", "?"))
    pv = [next(lost) if value != value else f"{value:.2f}" for value in LOOPS[0].pv_with_gaps]
    return table(("time", "FIC101.PV", "FIC101.OP"), [time, pv, num(LOOPS[0].op)])
