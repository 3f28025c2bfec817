"""Readings as instruments wrote them, from any file gonio reads."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import overload

import pyarrow as pa

from gonio import _native, bird, raw_parquet, rt300s
from gonio._native import DomainError, FormatError, Scan

PathLike = str | os.PathLike[str]

FORMATS = (
    "mountain",
    "gonio-raw",
    "nist-ptfe",
    "zemax-bsdf",
    "speos-bsdf",
    "astm",
    "table",
    "parquet",
    rt300s.FORMAT,
    bird.FORMAT,
)
"""Names of the formats of readings; docs/formats has a page on each."""

_EXPORTED = ["slice", "theta_i", "phi_i", "channel", "theta_s", "phi_s", "dsf"]
"""First columns of a table that `gonio.export` wrote."""


class Readings(Sequence[Scan]):
    """A list of scans: the readings of one or many files, one `Scan` an incidence, channel and purpose."""

    def __init__(self, scans: Iterable[Scan]) -> None:
        self._scans = list(scans)

    @overload
    def __getitem__(self, index: int) -> Scan: ...
    @overload
    def __getitem__(self, index: slice) -> Readings: ...
    def __getitem__(self, index: int | slice) -> Scan | Readings:
        """Return one scan, or the readings of a range of scans."""
        return Readings(self._scans[index]) if isinstance(index, slice) else self._scans[index]

    def __len__(self) -> int:
        """Return the number of scans."""
        return len(self._scans)

    def __iter__(self) -> Iterator[Scan]:
        """Iterate over the scans."""
        return iter(self._scans)

    def __add__(self, other: Readings) -> Readings:
        """Scans of both."""
        return Readings([*self._scans, *other])

    def __repr__(self) -> str:
        """Return scans, readings and channels in one line."""
        readings = sum(len(s) for s in self)
        return f"Readings(scans={len(self)}, readings={readings}, channels=[{', '.join(self.channels)}])"

    @property
    def channels(self) -> list[str]:
        """Names of the channels, in the order of the scans."""
        return list(dict.fromkeys(s.channel for s in self))

    @property
    def quantities(self) -> list[str]:
        """Names of the quantities, in the order of the scans."""
        return list(dict.fromkeys(s.quantity for s in self))

    def select(
        self, *, kind: str | None = None, channel: str | None = None, quantity: str | None = None
    ) -> Readings:
        """Scans of one kind, channel or quantity; None takes all."""
        wanted = {"kind": kind, "channel": channel, "quantity": quantity}
        return Readings(
            s
            for s in self
            if all(value is None or getattr(s, name) == value for name, value in wanted.items())
        )

    def to_table(self) -> pa.Table:
        """Table with one row a reading; columns as in docs/data-model.md."""
        return raw_parquet.table_of(self._scans)

    def save(self, path: PathLike) -> None:
        """Write gonio raw, whole or not at all: Parquet where `path` ends in .parquet, text otherwise."""
        if Path(path).suffix.lower() == ".parquet":
            raw_parquet.write(path, self._scans)
        else:
            _native.write_raw(path, self._scans)


def read(
    paths: PathLike | Sequence[PathLike],
    *,
    format: str | None = None,
    columns: Mapping[str, str] | None = None,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
    upphi: float | None = None,
) -> Readings:
    """Read the scans of one or many files, in file order.

    Parameters
    ----------
    paths
        One path or many; docs/formats lists the formats.
    format
        Name of the format (`FORMATS`); None recognises it.
    columns
        For generic CSV and Parquet: gonio's column names to those of the file, see docs/formats/table.md.
    kind, quantity, channel
        What the scans were taken for, what the values are and which spectral channel, for files that do not
        tell.
    upphi
        Azimuth of the sample's up mark in a Mountain file, degrees, in place of the file's own.

    Raises
    ------
    FormatError
        A file does not follow its format.
    QuantityError
        A file does not tell its quantity and none was given.
    DomainError
        A value outside its range.
    OSError
        The operating system refuses (no such file, no permission, a directory).
    """
    many = [paths] if isinstance(paths, (str, os.PathLike)) else paths
    scans: list[Scan] = []
    for path in many:
        scans += read_file(
            path,
            format=format,
            columns=columns,
            kind=kind,
            quantity=quantity,
            channel=channel,
            upphi=upphi,
        )[1]
    return Readings(scans)


def read_file(
    path: PathLike,
    *,
    format: str | None = None,
    columns: Mapping[str, str] | None = None,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
    upphi: float | None = None,
) -> tuple[str, list[Scan]]:
    """Name of the format and scans of one file; arguments and errors as in `read`."""
    stated = {"kind": kind, "quantity": quantity, "channel": channel}
    if format is not None and format.lower() not in FORMATS:
        raise DomainError(f"format: found {format!r}, allowed {', '.join(FORMATS)}")
    found = format.lower() if format else _binary_format(path)
    if not columns:
        _refuse_exported(Path(path))
    if found == "parquet":
        return found, raw_parquet.read(path, columns=columns, **stated)
    if found == rt300s.FORMAT:
        return found, rt300s.read(path, **stated)
    if found == bird.FORMAT:
        return found, bird.read(path, **stated)
    found = found or ("table" if columns else _native.detect_format(path))
    return found, _native.read_file(path, found, columns=columns, upphi=upphi, **stated)


def _binary_format(path: PathLike) -> str | None:
    """Format of a file that is no text, by its first bytes."""
    with Path(path).open("rb") as file:
        start = file.read(64)
    if start.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"{"):
        return bird.FORMAT
    return {b"PAR1": "parquet", rt300s.MAGIC[:4]: rt300s.FORMAT}.get(start[:4])


def _refuse_exported(path: Path) -> None:
    """Tell what to do with a file of processed readings, which lacks half of what a measurement holds."""
    with path.open("rb") as file:
        start = file.read(256)
    if start.startswith((b"\x89HDF", b"CDF")):
        raise FormatError(
            f"{path}: file: found HDF5 or netCDF, allowed {', '.join(FORMATS)}; gonio writes netCDF for "
            "other programs (xarray.open_dataset reads it) and takes the directory that gonio process wrote"
        )
    if start.replace(b'"', b"").startswith(",".join(_EXPORTED).encode()):
        raise FormatError(f"{path}: {raw_parquet.PROCESSED}")
