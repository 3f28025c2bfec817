"""The result of processing: DSF and BSDF with uncertainty, one slice an incidence and channel."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from gonio._native import (
    FLAGS,
    DomainError,
    FormatError,
    MeasurementData,
    Resolution,
    Slice,
    Verdict,
)
from gonio.files import check_file, replacing_directory, replacing_file, sha256
from gonio.measurement_header import (
    FORMAT,
    FORMAT_VERSION,
    FRAME,
    JSON_NAME,
    PARQUET_NAME,
    header_of,
    read_header,
    resolution_header,
    slice_header,
    slices_of,
)

if TYPE_CHECKING:
    import xarray as xr

# name -> (unit, long name) of every column of the table; docs/data-model.md carries the same list.
COLUMNS: dict[str, tuple[str, str]] = {
    "slice": ("1", "index of the slice"),
    "theta_i": ("degree", "polar angle of incidence from the front normal"),
    "phi_i": ("degree", "azimuth of incidence from the zero-azimuth mark"),
    "channel": ("", "spectral channel"),
    "theta_s": ("degree", "polar angle of the receiver from the front normal"),
    "phi_s": ("degree", "azimuth of the receiver from the zero-azimuth mark"),
    "dsf": ("sr-1", "differential scattering function, bsdf times |cos theta_s|"),
    "bsdf": ("sr-1", "bidirectional scattering distribution function"),
    "u_dsf": ("sr-1", "combined standard uncertainty of dsf"),
    "omega": ("sr", "solid-angle weight of the reading"),
    "flags": ("1", "bit flags of the reading"),
}


class Measurement:
    """A sample's processed slices with what holds for all of them.

    Parameters
    ----------
    slices
        One `Slice` an incidence and channel.
    sample_name
        Name of the sample.
    signature_fwhm
        Full width at half maximum of the instrument signature in degrees: no structure finer than this is
        resolved.
    resolutions
        What the readings of each channel with a beam scan resolve: one `Resolution` a channel.
    warnings
        Physics warnings found on the way.
    provenance
        Where the numbers come from: input files with their SHA-256, versions, settings, time.
    findings
        Verdicts that only the raw readings allow, made while processing.

    Raises
    ------
    DomainError
        `signature_fwhm` is not positive.
    """

    def __init__(
        self,
        slices: Sequence[Slice],
        *,
        sample_name: str | None = None,
        signature_fwhm: float | None = None,
        resolutions: Sequence[Resolution] = (),
        warnings: Sequence[str] = (),
        provenance: Mapping[str, Any] | None = None,
        findings: Sequence[Verdict] = (),
    ) -> None:
        self._data = MeasurementData(
            list(slices),
            sample_name=sample_name,
            signature_fwhm=signature_fwhm,
            resolutions=list(resolutions),
            warnings=list(warnings),
        )
        self._provenance = dict(provenance or {})
        self._findings = list(findings)

    @classmethod
    def _wrap(cls, data: MeasurementData, *, provenance: Mapping[str, Any]) -> Measurement:
        """Measurement around native data, without a copy."""
        self = cls.__new__(cls)
        self._data = data
        self._provenance = dict(provenance)
        self._findings = data.findings
        return self

    @property
    def slices(self) -> list[Slice]:
        """Slices in the order of the input."""
        return self._data.slices

    @property
    def sample_name(self) -> str | None:
        """Name of the sample, or None."""
        return self._data.sample_name

    @property
    def signature_fwhm(self) -> float | None:
        """Full width at half maximum of the instrument signature in degrees, or None without a beam scan."""
        return self._data.signature_fwhm

    @property
    def resolutions(self) -> list[Resolution]:
        """What the readings of each channel with a beam scan resolve."""
        return self._data.resolutions

    @property
    def warnings(self) -> list[str]:
        """Physics warnings found on the way."""
        return self._data.warnings

    @property
    def provenance(self) -> dict[str, Any]:
        """Input files with their SHA-256, versions, settings and time."""
        return self._provenance

    @property
    def findings(self) -> list[Verdict]:
        """Verdicts that only the raw readings allow (does the blank match?), made while processing."""
        return self._findings

    @property
    def channels(self) -> list[str]:
        """Names of the channels, in the order of the slices."""
        return list(dict.fromkeys(s.channel for s in self.slices))

    def __len__(self) -> int:
        """Return the number of slices."""
        return len(self.slices)

    def __iter__(self) -> Iterator[Slice]:
        """Iterate over the slices."""
        return iter(self.slices)

    def __repr__(self) -> str:
        """Return name, slices, readings and channels in one line."""
        readings = sum(len(s) for s in self.slices)
        channels = ", ".join(self.channels)
        return (
            f"Measurement({self.sample_name!r}, slices={len(self)}, readings={readings}, "
            f"channels=[{channels}])"
        )

    def summary(self) -> dict[str, Any]:
        """Plain values that describe the measurement: everything but the readings and the provenance."""
        readings = [len(s) for s in self.slices]
        return {
            "sample_name": self.sample_name,
            "signature_fwhm": self.signature_fwhm,
            "channels": self.channels,
            "readings": sum(readings),
            "warnings": self.warnings,
            "slices": [slice_header(s) for s in self.slices],
        }

    def to_table(self) -> pa.Table:
        """Table with one row a reading; columns as in docs/data-model.md, their units also in the schema."""
        slices = self.slices
        fields = [
            pa.field("slice", pa.uint32()),
            pa.field("theta_i", pa.float64()),
            pa.field("phi_i", pa.float64()),
            pa.field("channel", pa.dictionary(pa.int32(), pa.string())),
            *(pa.field(name, pa.float64()) for name in ("theta_s", "phi_s", "dsf", "bsdf", "u_dsf", "omega")),
            pa.field("flags", pa.uint16()),
        ]
        schema = pa.schema(
            [f.with_metadata({"unit": COLUMNS[f.name][0], "long_name": COLUMNS[f.name][1]}) for f in fields],
            metadata={"format": FORMAT, "frame": FRAME},
        )
        channels = self.channels

        def column(name: str) -> pa.ChunkedArray:
            parts = [np.ascontiguousarray(getattr(s, name)) for s in slices]
            return pa.chunked_array(parts, type=schema.field(name).type)

        def repeated(name: str) -> pa.ChunkedArray:
            parts = [np.full(len(s), getattr(s, name)) for s in slices]
            return pa.chunked_array(parts, type=pa.float64())

        def channel(s: Slice) -> pa.DictionaryArray:
            index = np.full(len(s), channels.index(s.channel), dtype=np.int32)
            return pa.DictionaryArray.from_arrays(index, channels)

        columns = {
            "slice": pa.chunked_array(
                [np.full(len(s), k, dtype=np.uint32) for k, s in enumerate(slices)], type=pa.uint32()
            ),
            "theta_i": repeated("theta_i"),
            "phi_i": repeated("phi_i"),
            "channel": pa.chunked_array([channel(s) for s in slices], type=schema.field("channel").type),
            **{name: column(name) for name in ("theta_s", "phi_s", "dsf", "bsdf", "u_dsf", "omega", "flags")},
        }
        return pa.table(columns, schema=schema)

    def to_xarray(self) -> xr.Dataset:
        """Dataset of dimensions `slice` and `reading`: a CF contiguous ragged array.

        `row_size(slice)` counts the readings of each slice; readings of slice 0 come first, then slice 1, and
        so on. Hemispherical integrals are variables over `slice` and `side`, NaN where a hemisphere was not
        measured. Units, long names, quantity, frame and provenance are attributes.
        """
        import xarray as xr  # noqa: PLC0415  (half a second that most verbs do not need)

        slices = self.slices

        def column(name: str) -> np.ndarray[Any, np.dtype[Any]]:
            return np.concatenate([getattr(s, name) for s in slices]) if slices else np.empty(0)

        def attrs(name: str) -> dict[str, Any]:
            unit, long_name = COLUMNS[name]
            return {"long_name": long_name, "units": unit} if unit else {"long_name": long_name}

        sides = ["front", "back"]
        integrals = {
            name: np.full((len(slices), 2), np.nan) for name in ("value", "extrapolated", "u", "u_quadrature")
        }
        for k, s in enumerate(slices):
            for integral in s.integrals:
                for name, block in integrals.items():
                    block[k, sides.index(integral.side)] = getattr(integral, name)
        long_names = {
            "value": "hemispherical integral of dsf (DHR or DHT)",
            "extrapolated": "part of the hemispherical integral in directions that were not measured",
            "u": "combined standard uncertainty of the hemispherical integral",
            "u_quadrature": "standard uncertainty of the quadrature",
        }
        readings = ("theta_s", "phi_s", "dsf", "bsdf", "u_dsf", "omega", "flags")
        variables: dict[str, Any] = {name: ("reading", column(name), attrs(name)) for name in readings}
        variables["flags"][2]["flag_masks"] = np.array(list(FLAGS.values()), dtype=np.uint16)
        variables["flags"][2]["flag_meanings"] = " ".join(FLAGS)
        for name in ("theta_i", "phi_i"):
            variables[name] = ("slice", np.array([getattr(s, name) for s in slices]), attrs(name))
        variables["channel"] = (
            "slice",
            np.array([s.channel for s in slices], dtype=object),
            attrs("channel"),
        )
        variables["row_size"] = (
            "slice",
            np.array([len(s) for s in slices], dtype=np.int64),
            {"long_name": "readings of the slice", "sample_dimension": "reading"},
        )
        variables["u_common"] = (
            "slice",
            np.array([s.u_common for s in slices]),
            {"long_name": "relative standard uncertainty common to the readings of the slice", "units": "1"},
        )
        for name, block in integrals.items():
            key = "integral" if name == "value" else f"integral_{name}"
            variables[key] = (("slice", "side"), block, {"long_name": long_names[name], "units": "1"})
        return xr.Dataset(
            variables,
            coords={"side": ("side", np.array(sides, dtype=object), {"long_name": "side of the receiver"})},
            attrs={
                "title": f"BSDF measurement of {self.sample_name or 'an unnamed sample'}",
                "Conventions": "CF-1.11",
                "format": FORMAT,
                "format_version": FORMAT_VERSION,
                "quantity": "dsf",
                "frame": FRAME,
                "sample_name": self.sample_name or "",
                "signature_fwhm": np.nan if self.signature_fwhm is None else self.signature_fwhm,
                "signature_fwhm_units": "degree",
                "resolutions": json.dumps([resolution_header(r) for r in self.resolutions]),
                "warnings": json.dumps(self.warnings),
                "provenance": json.dumps(self.provenance),
            },
        )

    def to_netcdf(self, path: str | os.PathLike[str]) -> None:
        """Write `to_xarray()` as netCDF-4, whole or not at all."""
        check_file(path)
        # The file is made in memory: HDF5 does not survive a disk that is full when it closes a file.
        content = self.to_xarray().to_netcdf(engine="h5netcdf")
        with replacing_file(path) as staged:
            staged.write_bytes(content)

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write the directory `path` with measurement.parquet and measurement.json, whole or not at all.

        Parameters
        ----------
        path
            The directory; its parent must exist. An earlier measurement there is replaced.
        force
            Write into a directory that holds other files, too.

        Raises
        ------
        FormatError
            `path` holds other files and `force` is not set.
        OSError
            The file system refuses.
        """
        table = self.to_table()
        with replacing_directory(path, marker=JSON_NAME, force=force) as staged:
            pq.write_table(table, staged / PARQUET_NAME, compression="zstd")
            text = json.dumps(header_of(self, sha256(staged / PARQUET_NAME)), indent=2, allow_nan=False)
            (staged / JSON_NAME).write_text(text + "\n", encoding="utf-8")

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Measurement:
        """Read a directory written by `save`.

        Raises
        ------
        FileNotFoundError
            No such directory, or no measurement.json or measurement.parquet in it.
        NotADirectoryError
            `path` is a file.
        FormatError
            The files are damaged, do not belong together or are of a newer format.
        """
        directory = Path(path)
        json_path, table_path = directory / JSON_NAME, directory / PARQUET_NAME
        if not directory.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(path))
        if not directory.is_dir():
            raise NotADirectoryError(
                errno.ENOTDIR,
                "is a file, needed is a directory of gonio process; models go to export, reduce or compare",
                str(path),
            )
        if not json_path.is_file():
            raise FileNotFoundError(
                errno.ENOENT, f"is no measurement directory, it holds no {JSON_NAME}", str(path)
            )
        header = read_header(json_path)
        found = sha256(table_path)
        if found != header["table"]["sha256"]:
            raise FormatError(
                f"{table_path}: found SHA-256 {found[:12]}…, {JSON_NAME} allows "
                f"{header['table']['sha256'][:12]}…: the file is damaged or belongs to another measurement"
            )
        try:
            slices = slices_of(header, pq.read_table(table_path))
            findings = [Verdict(**finding) for finding in header["findings"]]
            # Measurements saved before 22 November 2026 have none.
            resolutions = [Resolution(**r) for r in header.get("resolutions", [])]
        except (KeyError, TypeError, pa.ArrowException, DomainError) as error:
            raise FormatError(f"{directory}: found a damaged measurement ({error})") from error
        return cls(
            slices,
            sample_name=header["sample_name"],
            signature_fwhm=header["signature_fwhm"],
            resolutions=resolutions,
            warnings=header["warnings"],
            provenance=header["provenance"],
            findings=findings,
        )
