# ruff: noqa: PLR0124, FBT002, PLC0415, SIM905 - NaN, flags of writers, optional libraries, lists of words
"""Files as plants export them, all of one simulated truth, so that the right reading of each is known.

Each case is a function that returns the file's content; ``CASES`` has the name of the file, what must be read
and, where a file can be read in two ways, the option that settles it.
"""

import gzip
import io
import zipfile
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from zoneinfo import ZoneInfo

import numpy as np

from tests.exports.truth import LOOPS, START, TIME, TS, N

BERLIN = ZoneInfo("Europe/Berlin")
MONTHS = "Jan Feb Mar Apr May Jun Jul Aug Sep Oct Nov Dec".split()
MONATE = "Jan Feb Mär Apr Mai Jun Jul Aug Sep Okt Nov Dez".split()
ONE, ALL = LOOPS[:1], LOOPS


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


def xlsx(dates):
    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    sheet.append(["Report of area 100"])
    sheet.append(["Timestamp", "FIC101.PV", "FIC101.OP"])
    for k in range(N):
        moment = datetime.fromtimestamp(TIME[k], UTC).replace(tzinfo=None)
        sheet.append([moment if dates else iso(moment), float(LOOPS[0].pv[k]), float(LOOPS[0].op[k])])
    book.create_sheet("Notes").append(["nothing here"])
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()


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


def zipped(content):
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("export.csv", content)
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


ISO = stamps(iso)
LOCAL = stamps(iso, BERLIN)
EXCEL = [f"{25569 + each / 86400:.10f}" for each in TIME]
AUTUMN, AUTUMN_LOCAL = autumn()
HELD_FILE, HELD = interleaved()

CASES = (
    Case("plain_iso.csv", plain(ISO), ONE, single=True),
    Case("plain_semicolon_decimal_comma.csv", plain(ISO, numbers=comma, sep=";"), ONE, single=True),
    Case("plain_tab.txt", plain(ISO, sep="\t"), ONE, single=True),
    Case("plain_pipe.csv", plain(ISO, sep="|"), ONE, single=True),
    Case("lower_case_names.csv", plain(ISO, names=("Time", "op", "pv")), ONE, single=True),
    Case(
        "words_for_roles.csv",
        plain(ISO, names=("Timestamp", "Controller Output (%)", "Process Value [t/h]")),
        ONE,
        single=True,
    ),
    Case("units_row.csv", plain(ISO, units=("", "%", "t/h")), ONE, single=True),
    Case(
        "metadata_before.csv",
        plain(ISO, before="Report,Area 100\nExported,2026-03-02 06:00:00\n\n# raw values\n"),
        ONE,
        single=True,
    ),
    Case("one_bad_row.csv", one_bad_row(ISO), ONE, single=True),
    Case("epoch_seconds.csv", plain([f"{each:.0f}" for each in TIME]), ONE, single=True),
    Case("epoch_milliseconds.csv", plain([f"{each * 1e3:.0f}" for each in TIME]), ONE, single=True),
    Case("epoch_microseconds.csv", plain([f"{each * 1e6:.0f}" for each in TIME]), ONE, single=True),
    Case("epoch_nanoseconds.csv", plain([f"{int(each)}000000000" for each in TIME]), ONE, single=True),
    Case("excel_days.csv", plain(EXCEL), ONE, single=True),
    Case(
        "excel_days_decimal_comma.csv",
        plain([each.replace(".", ",") for each in EXCEL], numbers=comma, sep=";"),
        ONE,
        single=True,
    ),
    Case(
        "elapsed_milliseconds.csv",
        plain([f"{k * 5000}" for k in range(N)], names=("Time [ms]", "OP", "PV")),
        ONE,
        time=TS * np.arange(N),
        single=True,
    ),
    Case("iso_with_offset.csv", plain([f"{each}+01:00" for each in LOCAL]), ONE, single=True),
    Case("iso_zulu_fraction.csv", plain([f"{each}.000Z" for each in ISO]), ONE, single=True),
    Case("compact_digits.csv", plain(stamps(strf("%Y%m%d%H%M%S"))), ONE, single=True),
    Case("english_month.csv", wide(stamps(strf("%d-%b-%y %H:%M:%S"))), ALL),
    Case(
        "german_month.csv",
        plain(
            stamps(lambda m: f"{m.day:02}. {MONATE[m.month - 1]} {m.year} {m:%H:%M:%S}"),
            numbers=comma,
            sep=";",
        ),
        ONE,
        single=True,
    ),
    Case(
        "dotted_dates.csv", plain(stamps(strf("%d.%m.%Y %H:%M:%S")), numbers=comma, sep=";"), ONE, single=True
    ),
    Case("am_pm.csv", plain(stamps(strf("%m/%d/%Y %I:%M:%S %p"))), ONE, single=True),
    Case(
        "date_and_time_columns.csv",
        table(
            ("Date", "Time", "OP", "PV"),
            [stamps(strf("%Y-%m-%d")), stamps(strf("%H:%M:%S")), num(LOOPS[0].op), num(LOOPS[0].pv)],
        ),
        ONE,
        single=True,
    ),
    Case("newest_first.csv", newest_first(plain(ISO)), ONE, single=True),
    Case("utf16.csv", plain(ISO).decode().encode("utf-16"), ONE, single=True),
    Case("cp1252.csv", plain(ISO, units=("", "%", "m³/h")).decode().encode("cp1252"), ONE, single=True),
    Case("gzipped.csv.gz", gzip.compress(plain(ISO)), ONE, single=True),
    Case("zipped.zip", zipped(wide(ISO)), ALL),
    Case("wide_dots.csv", wide(ISO, roles=("PV", "OP", "SP")), ALL, sp=True),
    Case("wide_slashes.csv", wide(ISO, form="Area1/{loop}/{role}"), ALL),
    Case("wide_underscores.csv", wide(ISO, form="{loop}_{role}"), ALL),
    Case("deltav.csv", wide(ISO, form="{loop}/PID1/{role}.CV", roles=("PV", "OUT")), ALL),
    Case("yokogawa.csv", wide(ISO, roles=("PV", "SV", "MV")), ALL, sp=True),
    Case("ignition.csv", wide(ISO, form="[default]Area1/{loop}/{role}", first="t_stamp"), ALL),
    Case("two_header_lines.csv", two_lines(ISO), LOOPS[:2]),
    Case("wide_with_quality.csv", with_quality(ISO), ONE, gaps=True),
    Case("long_by_tag.csv", long(ISO), ALL, gaps=True),
    Case(
        "long_by_time.csv",
        long(
            ISO,
            by_tag=False,
            header=("TagName", "DateTime", "Value", "QualityDetail"),
            quality="192",
            bad="0",
        ),
        ALL,
        gaps=True,
    ),
    Case(
        "pi_no_good_data.csv",
        table(
            ("Timestamp", "\\\\PISRV\\FIC101.PV", "\\\\PISRV\\FIC101.OP"),
            [
                stamps(strf("%d-%b-%y %H:%M:%S")),
                num(LOOPS[0].pv_with_gaps, gap="No Good Data"),
                num(LOOPS[0].op),
            ],
        ),
        ONE,
        gaps=True,
    ),
    Case(
        "phd_confidence.csv",
        long(ISO, header=("Tagname", "TimeStamp", "Value", "Confidence"), quality="100", bad="0"),
        ALL,
        gaps=True,
    ),
    Case("interleaved.csv", HELD_FILE, ONE),
    Case(
        "thousands.csv",
        table(
            ("time", "OP", "PV"),
            [ISO, [f'"{v:,.2f}"' for v in LOOPS[2].op], [f'"{v:,.2f}"' for v in LOOPS[2].pv]],
        ),
        (LOOPS[2],),
        single=True,
    ),
    Case("workbook.xlsx", xlsx(dates=True), ONE),
    Case("workbook_text.xlsx", xlsx(dates=False), ONE),
    Case("zone.parquet", parquet("zone"), ONE),
    Case("milliseconds.parquet", parquet("ms"), ONE),
    Case("naive.parquet", parquet("naive"), ONE),
    Case(
        "quoted.csv", plain([f'"{each}"' for each in ISO], names=('"time"', '"OP"', '"PV"')), ONE, single=True
    ),
    Case("blank_lines_windows.csv", plain(ISO, end="\r\n\r\n"), ONE, single=True),
    Case("local_time.csv", plain(LOCAL), ONE, options={"zone": "Europe/Berlin"}, single=True),
    Case(
        "end_of_summer_time.csv",
        plain(AUTUMN_LOCAL),
        ONE,
        time=AUTUMN,
        settles={"zone": "Europe/Berlin"},
        names_option="--zone",
        single=True,
    ),
    Case(
        "day_or_month.csv",
        plain(stamps(strf("%d/%m/%Y %H:%M:%S"))),
        ONE,
        settles={"order": "dmy"},
        names_option="--date-order",
        single=True,
    ),
    Case(
        "three_decimals_comma.csv",
        plain(ISO, numbers=lambda v: comma(10 + np.abs(v) % 80, "{:.3f}"), sep=";"),
        ONE,
        settles={"decimal": ","},
        names_option="--decimal",
        single=True,
    ),
    Case(
        "days_or_seconds.csv",
        plain([f"{40000 + k * 0.02:.2f}" for k in range(N)]),
        ONE,
        time=40000 + 0.02 * np.arange(N),
        settles={"form": "seconds"},
        names_option="--time-format",
        single=True,
    ),
)

del timedelta, START
