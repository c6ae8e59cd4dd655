"""Files as plants export them, all of one simulated truth, so that the right reading of each is known.

Each case is a function that returns the file's content; ``CASES`` has the name of the file, what must be read
and, where a file can be read in two ways, the option that settles it.
"""

import gzip
from dataclasses import replace
from datetime import timedelta

import numpy as np

from tests.exports import matfiles
from tests.exports.elsewhere import (
    influx,
    letters_of_instruments,
    letters_of_instruments_by_row,
    roles_by_row,
)
from tests.exports.layouts import (
    BERLIN,
    MONATE,
    Case,
    comma,
    error_numbers,
    experion,
    fixed_width,
    header_repeated,
    interleaved,
    iso,
    long,
    newest_first,
    num,
    one_bad_row,
    parquet,
    plain,
    signs_and_status_names,
    stamps,
    status_columns,
    strf,
    table,
    two_lines,
    wide,
    wincc,
    with_quality,
    words_behind_tags,
    zipped,
)
from tests.exports.office import datalink, german_words, two_lines_of_times, units_in_cells, xlsx
from tests.exports.truth import LOOPS, START, TIME, TS, N
from tests.exports.unclear import UNCLEAR

ONE, ALL = LOOPS[:1], LOOPS
HYPHENS = tuple(replace(each, name=f"20-{each.name}") for each in LOOPS)
LETTERS = (replace(LOOPS[0], name="F-211"), replace(LOOPS[1], name="11-PD-107A"))
ISO = stamps(iso)


LOCAL = stamps(iso, BERLIN)


EXCEL = [f"{25569 + each / 86400:.10f}" for each in TIME]
MIDNIGHT = TIME - 8 * 3600 - 600
"""Times over a midnight, which shows the order of day and month."""
LATE = TIME + 14 * 86400
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
    Case(
        "windows_filetime.csv",
        plain([f"{int(each + 11644473600)}0000000" for each in TIME]),
        ONE,
        single=True,
    ),
    Case("dotnet_ticks.csv", plain([f"{int(each + 62135596800)}0000000" for each in TIME]), ONE, single=True),
    Case("labview_1904.csv", plain([f"{each + 2082844800:.3f}" for each in TIME]), ONE, single=True),
    Case(
        "time_of_day.csv",
        plain(stamps(strf("%H:%M:%S"))),
        ONE,
        time=8 * 3600 + TS * np.arange(N),
        single=True,
    ),
    Case(
        "elapsed_clock.csv",
        plain([f"0 days {timedelta(seconds=TS * k)}" for k in range(N)]),
        ONE,
        time=TS * np.arange(N),
        single=True,
    ),
    Case(
        "dates_over_midnight.csv",
        plain(stamps(strf("%d/%m/%Y %H:%M:%S"), moments=MIDNIGHT)),
        ONE,
        time=MIDNIGHT,
        single=True,
    ),
    Case(
        "month_first_late_day.csv",
        plain(stamps(strf("%m/%d/%Y %H:%M:%S"), moments=LATE)),
        ONE,
        time=LATE,
        single=True,
    ),
    Case("fixed_width.txt", fixed_width(ISO), ONE, single=True),
    Case("header_repeated.csv", header_repeated(ISO), ONE, single=True),
    Case("error_numbers.csv", error_numbers(ISO), ONE, gaps=True),
    Case("status_columns.csv", status_columns(), ONE, gaps=True),
    Case(
        "ignition_history.csv",
        long(
            [f"{each * 1e3:.0f}" for each in TIME],
            form="area1/{loop}/{role}",
            header=("tagpath", "t_stamp", "floatvalue", "dataintegrity"),
            quality="192",
            bad="0",
        ),
        ALL,
        gaps=True,
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
    Case(
        "a_table_a_loop.zip",
        zipped(
            **{f"export/{each.name}.csv": plain(ISO, each) for each in ALL}, **{"export/readme.txt": b"PI\n"}
        ),
        ALL,
    ),
    Case("experion_blocks.csv", experion(ISO), ONE),
    Case("wincc.csv", wincc(), ONE, gaps=True),
    Case(
        "unit_behind_time.csv",
        plain([f"{each * 1e6:.0f}" for each in TIME], names=("timestamp_us", "OP", "PV")),
        ONE,
        single=True,
    ),
    Case(
        "influx_measurement_and_field.csv",
        influx(("_field", "_measurement", "host"), ("{role}", "{loop}", "srv1")),
        ALL,
    ),
    Case(
        "influx_topic.csv",
        influx(("_field", "_measurement", "topic"), ("value", "mqtt", "area1/{loop}/{role}"), blocks=False),
        ALL,
    ),
    Case("grafana_rows.csv", long(ISO, header=("Metric", "Time", "Value")), ALL, gaps=True),
    Case("grafana_labels.csv", wide(ISO, form="{role} {{loop: {loop}}}"), ALL),
    Case(
        "prometheus_labels.csv",
        long(ISO, form='process_{role}{{loop="{loop}"}}', header=("Metric", "Time", "Value")),
        ALL,
        gaps=True,
    ),
    Case("roles_by_row.csv", roles_by_row(ISO), ONE, single=True),
    Case("letters_of_instruments.csv", letters_of_instruments(), LETTERS),
    Case("letters_of_instruments_long.csv", letters_of_instruments_by_row(ISO), LETTERS),
    Case("words_behind_tags.csv", words_behind_tags(ISO), ONE),
    Case("hyphens_in_tags.csv", wide(ISO, form="20-{loop} {role}", loops=LOOPS), HYPHENS),
    Case("signs_and_status_names.csv", signs_and_status_names(ISO), ONE, gaps=True),
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
    Case("tag_above_time_and_value.csv", two_lines_of_times(ISO), ONE),
    Case("datalink.xlsx", datalink(), ONE, gaps=True),
    Case("german_words.csv", german_words(), ONE, sp=True),
    Case("units_in_cells.csv", units_in_cells(ISO), ONE),
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
    Case("vectors.mat", matfiles.vectors(), ONE, time=TS * np.arange(N), single=True),
    Case("vectors_with_times.mat", matfiles.with_times(), ONE, gaps=True, single=True),
    Case("structures.mat", matfiles.structures(), ALL, time=TS * np.arange(N), sp=True),
    Case("zone.parquet", parquet("zone"), ONE),
    Case("milliseconds.parquet", parquet("ms"), ONE),
    Case("naive.parquet", parquet("naive"), ONE),
    Case(
        "quoted.csv", plain([f'"{each}"' for each in ISO], names=('"time"', '"OP"', '"PV"')), ONE, single=True
    ),
    Case("blank_lines_windows.csv", plain(ISO, end="\r\n\r\n"), ONE, single=True),
    *UNCLEAR,
)

del START
