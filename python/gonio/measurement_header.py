"""measurement.json beside measurement.parquet: what a saved measurement says besides its readings."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pyarrow as pa

from gonio._native import FLAGS, DomainError, FormatError, HemisphericalIntegral, Resolution, Slice

if TYPE_CHECKING:
    from gonio.measurement import Measurement

FORMAT = "gonio-measurement"
FORMAT_VERSION = 1
JSON_NAME = "measurement.json"
PARQUET_NAME = "measurement.parquet"
FRAME = (
    "right-handed, z = outward normal of the front, x = zero-azimuth mark; every direction leaves the surface"
)


def header_of(measurement: Measurement, digest: str) -> dict[str, Any]:
    """Everything but the readings, whose table has the SHA-256 `digest`."""
    return {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "sample_name": measurement.sample_name,
        "signature_fwhm": measurement.signature_fwhm,
        "resolutions": [resolution_header(r) for r in measurement.resolutions],
        "frame": FRAME,
        "flags": FLAGS,
        "warnings": measurement.warnings,
        "slices": [slice_header(s) for s in measurement.slices],
        "findings": [v.to_dict() for v in measurement.findings],
        "provenance": measurement.provenance,
        "table": {"name": PARQUET_NAME, "sha256": digest},
    }


def slice_header(s: Slice) -> dict[str, Any]:
    """What holds for a slice as a whole."""
    return {
        "theta_i": s.theta_i,
        "phi_i": s.phi_i,
        "channel": s.channel,
        "readings": len(s),
        "u_common": s.u_common,
        "integrals": [
            {
                "side": i.side,
                "value": i.value,
                "extrapolated": i.extrapolated,
                "u": i.u,
                "u_quadrature": i.u_quadrature,
            }
            for i in s.integrals
        ],
    }


def resolution_header(r: Resolution) -> dict[str, Any]:
    """Arguments of the `Resolution`; angles in degrees, the second moment in square degrees."""
    names = ("channel", "fwhm", "radius_50", "radius_90", "second_moment", "receiver_radius", "spot_radius")
    return {name: getattr(r, name) for name in names}


def read_header(path: Path) -> dict[str, Any]:
    """measurement.json, checked for format and version."""
    try:
        header = json.loads(path.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, json.JSONDecodeError) as error:
        raise FormatError(f"{path}: found no JSON ({error})") from error
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise FormatError(f'{path}: found no "format": "{FORMAT}", allowed is a file written by gonio')
    if header.get("format_version") != FORMAT_VERSION:
        raise FormatError(
            f"{path}: format_version: found {header.get('format_version')!r}, allowed {FORMAT_VERSION}"
        )
    needed = (
        "sample_name",
        "signature_fwhm",
        "warnings",
        "slices",
        "findings",
        "provenance",
        "table",
    )
    missing = [name for name in needed if name not in header]
    if missing or not isinstance(header["table"], dict) or "sha256" not in header["table"]:
        raise FormatError(f"{path}: found no {', '.join(missing) or 'table.sha256'}")
    return header


def slices_of(header: dict[str, Any], table: pa.Table) -> list[Slice]:
    """Slices of a saved table; the table lists the slices one after the other."""
    slices, start = [], 0
    for entry in header["slices"]:
        part = table.slice(start, entry["readings"])
        start += entry["readings"]
        columns = {
            name: part[name].to_numpy() for name in ("theta_s", "phi_s", "dsf", "u_dsf", "omega", "flags")
        }
        slices.append(
            Slice(
                theta_i=entry["theta_i"],
                phi_i=entry["phi_i"],
                channel=entry["channel"],
                u_common=entry["u_common"],
                integrals=[HemisphericalIntegral(**i) for i in entry["integrals"]],
                **columns,
            )
        )
    if start != table.num_rows:
        raise DomainError(f"readings: found {table.num_rows} rows, the header allows {start}")
    return slices
