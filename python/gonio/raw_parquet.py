"""Readings in Parquet: gonio raw (written by gonio) and tables of others with a column mapping."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from gonio._native import DomainError, FormatError, QuantityError, Scan
from gonio.files import replacing_file
from gonio.measurement_header import FORMAT as MEASUREMENT

FORMAT = "gonio-raw"
FORMAT_VERSION = 1

# name -> (unit, long name) of every column; docs/data-model.md carries the same list.
COLUMNS: dict[str, tuple[str, str]] = {
    "scan": ("1", "index of the scan"),
    "kind": ("", "what the scan was taken for: sample, beam, dark or standard"),
    "quantity": ("", "what the values are: signal, bsdf, dsf or reflectance_factor"),
    "channel": ("", "spectral channel"),
    "theta_i": ("degree", "polar angle of incidence from the front normal"),
    "phi_i": ("degree", "azimuth of incidence from the zero-azimuth mark"),
    "theta_s": ("degree", "polar angle of the receiver from the front normal"),
    "phi_s": ("degree", "azimuth of the receiver from the zero-azimuth mark"),
    "value": ("that of the quantity", "reading; NaN is no data"),
    "time": ("s", "time since the start of the scan; null when not recorded"),
}
NAMES = ("kind", "quantity", "channel")
ANGLES = ("theta_i", "phi_i")
READINGS = ("theta_s", "phi_s", "value")

PROCESSED = (
    "file: found processed readings that gonio wrote, allowed raw readings; give the directory that gonio "
    "process wrote, or state --column value=dsf --quantity dsf (columns=, quantity=) to take them as readings"
)
"""Error of a file that `gonio.export` wrote as a table."""

Array = npt.NDArray[Any]


def table_of(scans: Sequence[Scan]) -> pa.Table:
    """Table of `scans`, one row a reading, with what is known of each scan in the schema's metadata."""
    words = pa.dictionary(pa.int32(), pa.string())
    types = {"scan": pa.uint32(), **dict.fromkeys(NAMES, words)}
    schema = pa.schema(
        [
            pa.field(name, types.get(name, pa.float64()), metadata={"unit": unit, "long_name": long_name})
            for name, (unit, long_name) in COLUMNS.items()
        ],
        metadata={
            "format": FORMAT,
            "format_version": str(FORMAT_VERSION),
            "scans": json.dumps([_header(scan) for scan in scans]),
        },
    )

    def word(name: str) -> pa.ChunkedArray:
        dictionary = list(dict.fromkeys(getattr(s, name) for s in scans))
        parts = [
            pa.DictionaryArray.from_arrays(
                np.full(len(s), dictionary.index(getattr(s, name)), np.int32), dictionary
            )
            for s in scans
        ]
        return pa.chunked_array(parts, type=words)

    def time(scan: Scan) -> pa.Array:
        return pa.nulls(len(scan), pa.float64()) if scan.time is None else pa.array(scan.time)

    columns = {
        "scan": pa.chunked_array([np.full(len(s), k, np.uint32) for k, s in enumerate(scans)], pa.uint32()),
        **{name: word(name) for name in NAMES},
        **{
            name: pa.chunked_array([np.full(len(s), getattr(s, name)) for s in scans], pa.float64())
            for name in ANGLES
        },
        **{name: pa.chunked_array([getattr(s, name) for s in scans], pa.float64()) for name in READINGS},
        "time": pa.chunked_array([time(s) for s in scans], pa.float64()),
    }
    return pa.table(columns, schema=schema)


def write(path: str | os.PathLike[str], scans: Sequence[Scan]) -> None:
    """Write `scans` as gonio raw Parquet, whole or not at all."""
    table = table_of(scans)
    with replacing_file(path) as staged:
        pq.write_table(table, staged, compression="zstd")


def read(
    path: str | os.PathLike[str],
    *,
    columns: Mapping[str, str] | None = None,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
) -> list[Scan]:
    """Scans of a Parquet file.

    Parameters
    ----------
    path
        A file written by `write`, or any table with one row a reading.
    columns
        For the tables of others: gonio's name of a column (theta_i, phi_i, theta_s, phi_s, value; kind,
        quantity, channel, time where the table has them) to the name in the file. A name that is not given
        stands for itself; a finite number that names no column holds for every row. Angles are degrees, theta
        extended: a negative one, or one past 180, lies on the opposite azimuth. Rows that share kind,
        quantity, channel and incidence make one scan.
    kind, quantity, channel
        For tables without such a column.

    Raises
    ------
    FormatError
        The file is no Parquet file, is damaged, or lacks a column.
    QuantityError
        The table of another has no column for its quantity and none was given.
    OSError
        The operating system refuses.
    """
    file = Path(path)
    with file.open("rb") as handle:  # a missing file, a directory or a lack of permission is named here
        try:
            table = pq.read_table(handle)
        except pa.ArrowException as error:
            raise FormatError(f"{file}: found no readable Parquet file ({error})") from error
    metadata = {k.decode(): v.decode() for k, v in (table.schema.metadata or {}).items()}
    if metadata.get("format") == MEASUREMENT and not columns:
        raise FormatError(f"{file}: {PROCESSED}")
    try:
        if metadata.get("format") == FORMAT and columns is None:
            return _own(metadata, table, source=os.fspath(file))
        given = {"kind": kind or "sample", "quantity": quantity, "channel": channel}
        return _mapped(table, columns or {}, given, source=os.fspath(file))
    except (DomainError, QuantityError) as error:
        raise type(error)(f"{file}: {error}") from error
    except (KeyError, TypeError, ValueError, pa.ArrowException) as error:
        raise FormatError(f"{file}: found a damaged table ({error})") from error


def _header(scan: Scan) -> dict[str, Any]:
    return {
        "kind": scan.kind,
        "quantity": scan.quantity,
        "channel": scan.channel,
        "theta_i": scan.theta_i,
        "phi_i": scan.phi_i,
        "readings": len(scan),
        "timed": scan.time is not None,
        "meta": scan.meta,
    }


def _own(metadata: Mapping[str, str], table: pa.Table, *, source: str) -> list[Scan]:
    """Scans of a table made by `table_of`."""
    version = metadata.get("format_version")
    if version != str(FORMAT_VERSION):
        raise DomainError(f"format_version: found {version}, allowed {FORMAT_VERSION}")
    scans, start = [], 0
    for header in json.loads(metadata["scans"]):
        part = table.slice(start, header["readings"])
        start += header["readings"]
        scans.append(
            Scan(
                **{name: header[name] for name in (*NAMES, *ANGLES)},
                **{name: part[name].to_numpy() for name in READINGS},
                time=part["time"].to_numpy() if header["timed"] else None,
                meta={**header["meta"], "source": source},
            )
        )
    if start != table.num_rows:
        raise DomainError(f"readings: found {table.num_rows} rows, the header allows {start}")
    return scans


def _number(text: str) -> float | None:
    """The finite number that `text` spells, if it does."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if np.isfinite(number) else None


def _mapped(
    table: pa.Table, columns: Mapping[str, str], given: Mapping[str, str | None], *, source: str
) -> list[Scan]:
    """Scans of any table with one row a reading."""
    unknown = [name for name in columns if name not in COLUMNS or name == "scan"]
    if unknown:
        raise DomainError(f"columns: found {', '.join(unknown)}, allowed {', '.join(list(COLUMNS)[1:])}")

    def column(name: str) -> Array | None:
        in_file = columns.get(name, name)
        if in_file in table.column_names:
            return np.asarray(table[in_file].to_numpy())
        if name in columns:
            raise DomainError(f"columns: found no {in_file!r}, the file has {', '.join(table.column_names)}")
        return None

    def numbers(name: str) -> Array:
        given = columns.get(name)
        if given is not None and given not in table.column_names and (constant := _number(given)) is not None:
            return np.full(table.num_rows, constant)
        values = column(name)
        if values is None:
            raise DomainError(
                f"columns: found no column for {name}, the file has {', '.join(table.column_names)}; "
                f"map one of them"
            )
        return np.asarray(values, dtype=np.float64)

    data = {name: numbers(name) for name in (*ANGLES, *READINGS)}
    time = numbers("time") if "time" in columns or "time" in table.column_names else None
    words: dict[str, Array | str] = {}
    for name in NAMES:
        values = column(name)
        if values is not None:
            words[name] = values.astype(str)
        else:
            default = given[name]
            if default is None:
                raise QuantityError(f"{name}: found neither a column nor an option, needed one of them")
            words[name] = default
    keys = [data[name] for name in ANGLES] + [
        np.unique(w, return_inverse=True)[1].astype(np.float64)
        for w in words.values()
        if not isinstance(w, str)
    ]
    rows = np.stack(keys, axis=1)
    _, first, group = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    group = group.reshape(-1)
    order = np.argsort(group, kind="stable")
    bounds = np.flatnonzero(np.diff(group[order], prepend=-1, append=-1))
    scans = []
    for k in np.argsort(first):  # scans in the order of their first reading
        index = order[bounds[k] : bounds[k + 1]]
        scans.append(
            Scan(
                **{name: w if isinstance(w, str) else str(w[index[0]]) for name, w in words.items()},
                theta_i=float(data["theta_i"][index[0]]),
                phi_i=float(data["phi_i"][index[0]]),
                theta_s=data["theta_s"][index],
                phi_s=data["phi_s"][index],
                value=data["value"][index],
                time=None if time is None else time[index],
                meta={"source": source},
            )
        )
    return scans
