"""A table of PostgreSQL (or TimescaleDB) with a row a value, read through a cursor of the server."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any
from zoneinfo import ZoneInfo

from connectors.base import ConfigError
from connectors.exports.cells.quality_words import usable
from connectors.exports.fault import RecordingError
from connectors.sources.address import PASSWORD, credential, parted, without_password
from connectors.sources.collected import CollectedTag
from connectors.sources.tag_source import TagSource

if TYPE_CHECKING:
    import psycopg

    from connectors.exports.recorded import ReadOptions

ROWS = 10_000
"""Of one page of a cursor."""
PATIENCE = 10
"""For a connection, s."""
WITH_ZONE, WITHOUT_ZONE = 1184, 1114
"""Types ``timestamptz`` and ``timestamp`` (pg_type.dat)."""
COLUMNS = ("tag", "time", "value")


class SqlTable(TagSource):
    """``postgresql://USER@HOST/DATABASE?table=samples``.

    ``tag=``, ``time=``, ``value=`` and ``quality=`` name columns that have other names. The password comes
    from SLIPJUMP_PASSWORD, PGPASSWORD or a PGPASSFILE.
    """

    def __init__(self, name: str, options: ReadOptions) -> None:
        """Make it; nothing is connected yet."""
        super().__init__(name, options)
        known = {"table", "quality", "sslmode", *COLUMNS}
        self._address = parted(name, known, {"table"})
        self._columns = {each: self._address.parameters.get(each, each) for each in COLUMNS}
        self._quality = self._address.parameters.get("quality")
        self._connection: psycopg.Connection[Any] | None = None

    def close(self) -> None:
        """Close the connection."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def tags(self) -> Iterator[str]:
        """Yield the different tags of the table."""
        from psycopg import sql  # noqa: PLC0415 - only where it is used

        text = sql.SQL("SELECT DISTINCT {tag} FROM {table} WHERE {tag} IS NOT NULL ORDER BY 1")
        for (tag,) in self._rows(text.format(**self._names()), (), "its tags"):
            yield str(tag)

    def collect(self, wanted: Mapping[str, CollectedTag]) -> None:
        """Read the values of some tags."""
        from psycopg import sql  # noqa: PLC0415

        names = self._names()
        start, end = self._limits()
        quality = ", {quality}" if self._quality else ""
        where = "{tag} = %s AND {time} >= %s AND {time} < %s"
        picked = f"{{time}}, {{value}}{quality}"
        # the pieces are ours, the names of columns are composed below
        text = sql.SQL(f"SELECT {picked} FROM {{table}} WHERE {where} ORDER BY {{time}}")  # noqa: S608
        for tag, into in wanted.items():
            for row in self._rows(text.format(**names), (tag, start, end), f"tag {tag}"):
                if row[0] is not None:
                    good = not self._quality or row[2] is None or bool(usable([str(row[2])])[0])
                    into.add(self._seconds(row[0]), _plain(row[1]), good=good)

    def _names(self) -> dict[str, Any]:
        from psycopg import sql  # noqa: PLC0415

        names = {key: sql.Identifier(column) for key, column in self._columns.items()}
        table = sql.Identifier(*self._address.parameters["table"].split("."))
        return {**names, "table": table, "quality": sql.Identifier(self._quality or "quality")}

    def _limits(self) -> tuple[object, object]:
        """Return the span in the type of the column of times."""
        from psycopg import Error, sql  # noqa: PLC0415

        try:
            text = sql.SQL("SELECT {time} FROM {table} LIMIT 0").format(**self._names())
            described = self._open().execute(text).description
        except Error as error:
            raise self._fault(error, "its times") from error
        kind = described[0].type_code if described else 0
        if kind not in {WITH_ZONE, WITHOUT_ZONE}:
            return self.start, self.end
        limits = [datetime.fromtimestamp(each, UTC) for each in (self.start, self.end)]
        if kind == WITHOUT_ZONE:
            limits = [each.astimezone(self._zone()).replace(tzinfo=None) for each in limits]
        return limits[0], limits[1]

    def _seconds(self, time: Any) -> float:  # noqa: ANN401 - of the database
        if isinstance(time, datetime):
            return (time if time.tzinfo else time.replace(tzinfo=self._zone())).timestamp()
        return float(time)

    def _zone(self) -> ZoneInfo:
        return ZoneInfo(self.options.times.zone or "UTC")

    def _rows(self, text: Any, values: tuple[object, ...], what: str) -> Iterator[tuple[Any, ...]]:  # noqa: ANN401
        """Yield rows page by page: neither side holds all of them."""
        from psycopg import Error  # noqa: PLC0415

        try:
            connection = self._open()
            with connection.transaction(), connection.cursor("slipjump") as cursor:
                cursor.itersize = ROWS
                cursor.execute(text, values)
                yield from cursor
        except Error as error:
            self.close()
            raise self._fault(error, what) from error

    def _open(self) -> psycopg.Connection[Any]:
        if self._connection is None:
            import psycopg  # noqa: PLC0415

            address = self._address
            base = f"postgresql://{address.host}{address.path}"
            extra: dict[str, Any] = {"connect_timeout": PATIENCE, "application_name": "slipjump"}
            if "sslmode" in address.parameters:
                extra["sslmode"] = address.parameters["sslmode"]
            password = credential(PASSWORD)
            if password is not None:
                extra["password"] = password
            if address.user is not None:
                extra["user"] = address.user
            try:
                self._connection = psycopg.connect(base, autocommit=True, **extra)
            except psycopg.Error as error:
                raise self._fault(error, "cannot be opened") from error
        return self._connection

    def _fault(self, error: Exception, what: str) -> ConfigError:
        first = " ".join(str(error).split()) or type(error).__name__
        return RecordingError(f"{without_password(self.name)}: {what}: {first}")


def _plain(value: object) -> object:
    """Return a number of any type of the database as a float."""
    return value if value is None or isinstance(value, str | float | int) else float(value)  # type: ignore[arg-type]
