# ruff: noqa: PLR0124, PLC0415 - NaN, optional libraries
"""Exports as people make them in spreadsheets and dashboards: workbooks, German words, units in cells."""

import io
from datetime import UTC, datetime

from tests.exports.layouts import comma, iso, num, stamps, strf, table
from tests.exports.truth import LOOPS, TIME, N


def saved(book):
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()


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
    return saved(book)


def german_words():
    """Excel in German: words for the roles, date and time in two columns, decimal comma, code page 1252."""
    loop = LOOPS[0]
    names = ("Datum", "Uhrzeit", "FIC101 Istwert", "FIC101 Stellgröße", "FIC101 Sollwert")
    cells = [
        stamps(strf("%d.%m.%Y")),
        stamps(strf("%H:%M:%S")),
        comma(loop.pv),
        comma(loop.op),
        comma(loop.sp),
    ]
    return table(names, cells, sep=";", end="\r\n").decode().encode("cp1252")


def units_in_cells(time):
    """A unit behind each value, as dashboards export it."""
    loop = LOOPS[0]
    pv = [f"{cell} t/h" for cell in num(loop.pv)]
    return table(("Time", "FIC101.PV", "FIC101.OP"), [time, pv, [f"{cell} %" for cell in num(loop.op)]])


def two_lines_of_times(time):
    """A tag above each pair of time and value."""
    loop = LOOPS[0]
    before = "FIC101.PV,,FIC101.OP,\n"
    return table(("Time", "Value", "Time", "Value"), [time, num(loop.pv), time, num(loop.op)], before=before)


def datalink():
    """PI DataLink: nothing but a tag above times and values."""
    from openpyxl import Workbook

    book = Workbook()
    book.active.append(["FIC101.PV", None, "FIC101.OP"])
    for k in range(N):
        moment = datetime.fromtimestamp(TIME[k], UTC).replace(tzinfo=None)
        value = float(LOOPS[0].pv_with_gaps[k])
        pv = value if value == value else "No Good Data"
        book.active.append([moment, pv, moment, float(LOOPS[0].op[k])])
    return saved(book)
