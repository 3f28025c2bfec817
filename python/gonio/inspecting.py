"""What is in files, before anything is made of them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gonio._native import Scan, Slice
from gonio.files import sha256
from gonio.measurement import JSON_NAME, Measurement
from gonio.readings import PathLike, read_file


@dataclass(frozen=True)
class RecordSummary:
    """One scan or slice. Angles are degrees; ranges are None without any finite value."""

    kind: str
    quantity: str
    channel: str
    theta_i: float
    phi_i: float
    readings: int
    theta_s_min: float | None
    theta_s_max: float | None
    value_min: float | None
    value_max: float | None
    negative: int
    no_data: int
    repeated: int

    @property
    def notes(self) -> list[str]:
        """What stands out in this record."""
        notes = [] if self.readings else ["empty"]
        for count, text in (
            (self.negative, "negative"),
            (self.no_data, "no data"),
            (self.repeated, "repeated"),
        ):
            if count:
                notes.append(f"{count} {text}")
        return notes


@dataclass(frozen=True)
class FileSummary:
    """One file with its records, in file order."""

    path: str
    format: str
    bytes: int
    sha256: str
    records: list[RecordSummary]


@dataclass(frozen=True)
class Inspection:
    """Files, and what stands between them and processing."""

    files: list[FileSummary]
    problems: list[str]

    @property
    def records(self) -> list[RecordSummary]:
        """Records of every file."""
        return [record for file in self.files for record in file.records]

    @property
    def readings(self) -> int:
        """Readings in every file together."""
        return sum(record.readings for record in self.records)

    @property
    def channels(self) -> list[str]:
        """Channels in the order of the records."""
        return list(dict.fromkeys(r.channel for r in self.records))

    @property
    def quantities(self) -> list[str]:
        """Quantities in the order of the records."""
        return list(dict.fromkeys(r.quantity for r in self.records))

    @property
    def incidences(self) -> list[tuple[float, float]]:
        """Distinct (theta_i, phi_i) of the sample records in degrees, in the order of the records."""
        return list(
            dict.fromkeys((r.theta_i, r.phi_i) for r in self.records if r.kind in ("sample", "processed"))
        )

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio inspect --json` prints them."""
        return {
            "files": [
                {**asdict(f), "records": [{**asdict(r), "notes": r.notes} for r in f.records]}
                for f in self.files
            ],
            "readings": self.readings,
            "channels": self.channels,
            "quantities": self.quantities,
            "incidences": self.incidences,
            "problems": self.problems,
        }


def inspect(
    paths: PathLike | Sequence[PathLike],
    *,
    format: str | None = None,
    columns: Mapping[str, str] | None = None,
    quantity: str | None = None,
    channel: str | None = None,
) -> Inspection:
    """Summarise reading files and measurement directories.

    Parameters
    ----------
    paths
        One path or many.
    format, columns, quantity, channel
        As in `gonio.read`.

    Raises
    ------
    FormatError, QuantityError, DomainError, OSError
        As `gonio.read` and `Measurement.load`.
    """
    many = [paths] if isinstance(paths, (str, os.PathLike)) else list(paths)
    options: dict[str, Any] = {
        "format": format,
        "columns": columns,
        "quantity": quantity,
        "channel": channel,
    }
    files = [_summary(Path(path), options) for path in many]
    return Inspection(files=files, problems=_problems(files))


def _summary(path: Path, options: Mapping[str, Any]) -> FileSummary:
    if (path / JSON_NAME).is_file():
        measurement = Measurement.load(path)
        parts = [p for p in path.iterdir() if p.is_file()]
        return FileSummary(
            path=os.fspath(path),
            format="gonio-measurement",
            bytes=sum(p.stat().st_size for p in parts),
            sha256=sha256(path / JSON_NAME),
            records=[_record(s) for s in measurement.slices],
        )
    found, scans = read_file(path, **options)
    return FileSummary(
        path=os.fspath(path),
        format=found,
        bytes=path.stat().st_size,
        sha256=sha256(path),
        records=[_record(s) for s in scans],
    )


def _record(scan: Scan | Slice) -> RecordSummary:
    theta_s = scan.theta_s
    value = scan.dsf if isinstance(scan, Slice) else scan.value
    finite = value[np.isfinite(value)]
    directions = np.round(np.stack([theta_s, scan.phi_s], axis=1), 6)
    return RecordSummary(
        kind="processed" if isinstance(scan, Slice) else scan.kind,
        quantity="dsf" if isinstance(scan, Slice) else scan.quantity,
        channel=scan.channel,
        theta_i=round(scan.theta_i, 9),
        phi_i=round(scan.phi_i, 9),
        readings=len(value),
        theta_s_min=float(theta_s.min()) if len(theta_s) else None,
        theta_s_max=float(theta_s.max()) if len(theta_s) else None,
        value_min=float(finite.min()) if len(finite) else None,
        value_max=float(finite.max()) if len(finite) else None,
        negative=int(np.count_nonzero(finite < 0)),
        no_data=len(value) - len(finite),
        repeated=len(value) - len(np.unique(directions, axis=0)),
    )


def _problems(files: Sequence[FileSummary]) -> list[str]:
    """What stands between these files and `gonio process`, in sentences."""
    records = [r for file in files for r in file.records]
    problems = [f"{f.path}: holds no record" for f in files if not f.records]
    quantities = list(dict.fromkeys(r.quantity for r in records))
    if len(quantities) > 1:
        problems.append(f"mixed quantities ({', '.join(quantities)}): process them apart")
    samples = {r.channel for r in records if r.kind == "sample"}
    beams = {r.channel for r in records if r.kind == "beam"}
    if "signal" in quantities and not beams and not any(r.kind == "standard" for r in records):
        problems.append(
            "raw signals without a reference scan of the beam or a standard: "
            "name one with --beam or --standard"
        )
    elif beams and samples - beams:
        problems.append(f"no reference scan of the beam in channel {', '.join(sorted(samples - beams))}")
    if any(r.kind == "sample" and r.quantity == "signal" for r in records) and not any(
        r.kind == "dark" for r in records
    ):
        problems.append(
            "raw signals without dark readings: name them with --dark in gonio process, "
            "unless the instrument has subtracted its dark already"
        )
    empty = sum(r.readings == 0 for r in records)
    if empty:
        problems.append(f"{empty} empty scans")
    return problems
