"""Exports that can be read in two ways: refused, with the option that settles them."""

import numpy as np

from tests.exports.layouts import BERLIN, Case, autumn, comma, iso, newest_first, plain, stamps, strf
from tests.exports.truth import LOOPS, TS, N

ONE = LOOPS[:1]
ISO = stamps(iso)
LOCAL = stamps(iso, BERLIN)
AUTUMN, AUTUMN_LOCAL = autumn()

UNCLEAR = (
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
        "end_of_summer_time_newest_first.csv",
        newest_first(plain(AUTUMN_LOCAL)),
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
        "year_first_short.csv",
        plain(stamps(strf("%y-%m-%d %H:%M:%S"))),
        ONE,
        settles={"order": "ymd"},
        names_option="--date-order",
        single=True,
    ),
    Case(
        "am_pm_with_points.csv",
        plain([f"{each} a.m." for each in stamps(strf("%d/%m/%Y %I:%M:%S"))]),
        ONE,
        settles={"order": "dmy"},
        names_option="--date-order",
        single=True,
    ),
    Case(
        "minutes_without_unit.csv",
        plain([f"{k * TS / 60:.6f}" for k in range(N)]),
        ONE,
        time=TS * np.arange(N),
        settles={"form": "min"},
        names_option="--time-format",
        single=True,
    ),
    Case(
        "days_since_start.csv",
        plain([f"{k * TS / 86400:.8f}" for k in range(N)]),
        ONE,
        time=TS * np.arange(N),
        settles={"form": "days"},
        names_option="--time-format",
        single=True,
    ),
    Case(
        "milliseconds_without_unit.csv",
        plain([f"{k * TS * 1e3:.0f}" for k in range(N)]),
        ONE,
        time=TS * np.arange(N),
        settles={"form": "ms"},
        names_option="--time-format",
        single=True,
    ),
    Case(
        "seconds_cut_off.csv",
        plain(stamps(strf("%Y-%m-%d %H:%M"))),
        ONE,
        time=TS * np.arange(N),
        settles={"ts": TS},
        names_option="--ts",
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
