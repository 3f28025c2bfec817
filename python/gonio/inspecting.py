"""What is in files, before anything is made of them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from gonio import model_files
from gonio._native import GonioError, Scan, Slice
from gonio.files import sha256
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.model_files import MATERIAL_SUFFIXES, ModelSummary
from gonio.radiance_materials import read_materials
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
    phi_s_min: float | None
    phi_s_max: float | None
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
            # A closed shutter is read many times in one place.
            if count and not (self.kind == "dark" and text == "repeated"):
                notes.append(f"{count} {text}")
        return notes


@dataclass(frozen=True)
class MaterialSummary:
    """One material of a Radiance scene."""

    type: str
    id: str
    modifier: str
    line: int
    parameters: dict[str, float]
    strings: list[str]


@dataclass(frozen=True)
class FileSummary:
    """One file with its records, in file order, its model or its materials.

    A name is None where the file states none, `materials` where the file is not a Radiance scene.
    """

    path: str
    format: str
    bytes: int
    sha256: str
    records: list[RecordSummary]
    sample_name: str | None = None
    instrument: str | None = None
    model: ModelSummary | None = None
    materials: list[MaterialSummary] | None = None


@dataclass(frozen=True)
class Inspection:
    """Files, what stands between them and processing, and why files in `failed` could not be read."""

    files: list[FileSummary]
    problems: list[str]
    failed: dict[str, GonioError | OSError] = field(default_factory=dict)

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
            "failed": {path: str(error) for path, error in self.failed.items()},
        }


def inspect(
    paths: PathLike | Sequence[PathLike],
    *,
    format: str | None = None,
    columns: Mapping[str, str] | None = None,
    quantity: str | None = None,
    channel: str | None = None,
    upphi: float | None = None,
    keep_going: bool = False,
) -> Inspection:
    """Summarise reading files, measurement directories, models (BSDF XML, RGL) and Radiance materials.

    Parameters
    ----------
    paths
        One path or many.
    format, columns, quantity, channel, upphi
        As in `gonio.read`; of a model's file `channel` takes one out.
    keep_going
        Put files that cannot be read into `Inspection.failed` and go on with the others.

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
        "upphi": upphi,
    }
    files: list[FileSummary] = []
    failed: dict[str, GonioError | OSError] = {}
    for path in many:
        try:
            files.append(_summary(Path(path), options))
        except (GonioError, OSError) as error:
            if not keep_going:
                raise
            failed[os.fspath(path)] = error
    return Inspection(files=files, problems=_problems(files), failed=failed)


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
            sample_name=measurement.sample_name,
        )
    if options["format"] is None and path.suffix.lower() in MATERIAL_SUFFIXES:
        return FileSummary(
            path=os.fspath(path),
            format="radiance-material",
            bytes=path.stat().st_size,
            sha256=sha256(path),
            records=[],
            materials=[
                MaterialSummary(m.type, m.id, m.modifier, m.line, m.parameters, m.strings)
                for m in read_materials(path)
            ],
        )
    kind = model_files.model_format(path) if options["format"] is None else None
    if kind is not None:
        model = model_files.summarise(path, channel=options["channel"])
        return FileSummary(
            path=os.fspath(path),
            format=kind,
            bytes=path.stat().st_size,
            sha256=sha256(path),
            records=[],
            sample_name=model.name or None,
            model=model,
        )
    found, scans = read_file(path, **options)
    return FileSummary(
        path=os.fspath(path),
        format=found,
        bytes=path.stat().st_size,
        sha256=sha256(path),
        records=[_record(s) for s in scans],
        sample_name=_stated(scans, "sample_name"),
        instrument=_stated(scans, "instrument"),
    )


def _stated(scans: Sequence[Scan], name: str) -> str | None:
    """What the scans state under `name`, each value once."""
    return ", ".join(dict.fromkeys(str(s.meta[name]) for s in scans if s.meta.get(name))) or None


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
        phi_s_min=float(scan.phi_s.min()) if len(theta_s) else None,
        phi_s_max=float(scan.phi_s.max()) if len(theta_s) else None,
        value_min=float(finite.min()) if len(finite) else None,
        value_max=float(finite.max()) if len(finite) else None,
        negative=int(np.count_nonzero(finite < 0)),
        no_data=len(value) - len(finite),
        repeated=len(value) - len(np.unique(directions, axis=0)),
    )


def _problems(files: Sequence[FileSummary]) -> list[str]:
    """What stands between these files and `gonio process`, in sentences."""
    records = [r for file in files for r in file.records]
    problems = [
        f"{f.path}: holds no record"
        for f in files
        if not f.records and f.model is None and f.materials is None
    ]
    problems += [f"{f.path}: holds no material" for f in files if f.materials == []]
    problems += [f"{f.path}: a model, not readings: gonio.read_bsdf evaluates it" for f in files if f.model]
    problems += [f"{f.path}: {note}" for f in files if f.model for note in f.model.notes]
    quantities = list(dict.fromkeys(r.quantity for r in records))
    if len(quantities) > 1:
        problems.append(f"mixed quantities ({', '.join(quantities)}): process them apart")
    kinds = {r.kind for r in records}
    samples = {r.channel for r in records if r.kind == "sample"}
    beams = {r.channel for r in records if r.kind == "beam"}
    signals = any(r.kind == "sample" and r.quantity == "signal" for r in records)
    if signals and "dark" not in kinds:
        problems.append("raw signals without a dark or blank scan: name one with --dark of gonio process")
    if signals and not beams and "standard" not in kinds:
        problems.append(
            "raw signals without a reference scan of the beam or a standard: "
            "name one with --beam or --standard of gonio process"
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
        problems.append(f"{empty} empty scan{'s' if empty > 1 else ''}")
    return problems
