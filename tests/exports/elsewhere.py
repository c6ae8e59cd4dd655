"""Exports without words for roles in their names, or with the loop in one column and the role in another."""

from tests.exports.layouts import iso, newest_first, num, stamps, strf, table
from tests.exports.truth import LOOPS, N

INSTRUMENTS = (
    ("FT_211", LOOPS[0].pv),
    ("FV_211", LOOPS[0].op),
    ("11-PDIT-107A [bar]", LOOPS[1].pv),
    ("11-PDCV-107A", LOOPS[1].op),
    ("TI_9", LOOPS[2].pv),
)


def letters_of_instruments():
    """A transmitter and a valve a loop, number, date and time before them, newest first."""
    number = [str(1606681 + k) for k in range(N)]
    columns = [number, stamps(strf("%Y-%m-%d")), stamps(strf("%H:%M:%S"))]
    columns += [num(values) for _, values in INSTRUMENTS]
    return newest_first(table(("id", "date", "time", *(name for name, _ in INSTRUMENTS)), columns))


def letters_of_instruments_by_row(time):
    rows = [(name, time[k], f"{values[k]:.2f}") for name, values in INSTRUMENTS for k in range(N)]
    return table(("tag", "time", "value"), list(zip(*rows, strict=True)))


def influx(names, cells, *, blocks=True):
    """Annotated CSV of InfluxDB: ``names`` are its columns of tags, ``cells`` their content."""
    head = [
        "#group,false,false,true,true,false,false" + ",true" * len(names),
        "#datatype,string,long,dateTime:RFC3339,dateTime:RFC3339,dateTime:RFC3339,double"
        + ",string" * len(names),
        "#default,_result,,,,," + "," * len(names),
        ",result,table,_start,_stop,_time,_value," + ",".join(names),
    ]
    rows, time = [], stamps(lambda moment: f"{iso(moment)}.000000000Z")
    for table_number, (loop, role) in enumerate((loop, role) for loop in LOOPS for role in ("PV", "OP")):
        if blocks or not rows:
            rows += ["", *head] if rows else head
        own = ",".join(each.format(loop=loop.name, role=role) for each in cells)
        rows += [
            f",,{table_number},{time[0]},{time[-1]},{time[k]},{value:.2f},{own}"
            for k, value in enumerate(getattr(loop, role.lower()))
        ]
    return ("\r\n".join(rows) + "\r\n\r\n").encode()


def roles_by_row(time):
    """A row a value of one loop, whose name the file has."""
    rows = [
        (time[k], role, f"{getattr(LOOPS[0], role.lower())[k]:.2f}")
        for role in ("PV", "OP")
        for k in range(N)
    ]
    return table(("Time", "Field", "Value"), list(zip(*rows, strict=True)))
