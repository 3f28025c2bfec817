"""Files of gonio's compact model: netCDF 3, docs/formats/gonio-compact.md."""

from __future__ import annotations

import hashlib
import io
import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gonio import _native
from gonio._native import Compact, DomainError, FormatError
from gonio.files import check_file, replacing_file
from gonio.readings import PathLike

COMPACT_FORMAT = "gonio-compact"
VERSION = 2
MAGIC = (b"CDF\x01", b"CDF\x02")
"""First bytes of netCDF 3 files: classic and 64-bit offset."""

SIDES = ("front", "back")
COMPONENTS = ("reflection", "transmission")
_LOG = "coded logarithms of the ratio of the BSDF to its base, offset + step * code, channel after channel"

Array = NDArray[Any]
Variable = tuple[tuple[str, ...], Array, dict[str, Any]]
"""Dimensions, values and attributes."""
Opened = tuple[dict[str, Any], dict[str, Variable]]
"""Attributes and variables of a file."""

_NO_DIGEST = b"0" * 64
# netCDF 3 has type and length, four bytes each, between name and text of an attribute
_CHECKSUM = re.compile(rb"checksum.{8}sha256:([0-9a-f]{64})", re.DOTALL)


def write_compact(
    path: PathLike, model: Compact, *, name: str = "", provenance: Mapping[str, Any] | None = None
) -> None:
    """Write a compact model, whole or not at all.

    Parameters
    ----------
    path
        The file.
    model
        What `gonio.reduce` made, or a file of it holds.
    name
        Name of the material.
    provenance
        Where the model comes from; kept as JSON.

    Raises
    ------
    OSError
        The operating system refuses; nothing is left behind.
    """
    check_file(path)
    content = _content(model, name=name, provenance=dict(provenance or {}))
    with replacing_file(path) as staged:
        staged.write_bytes(content)


def read_compact(path: PathLike) -> Compact:
    """Read a compact model.

    Raises
    ------
    FormatError
        The file is no compact model, is damaged, or was written in a newer version of the format.
    OSError
        The operating system refuses.
    """
    return _model(Path(path), _opened(Path(path)))


def compact_header(path: PathLike) -> dict[str, Any]:
    """Name and provenance of a compact model's file, and the errors that its maker found.

    Returns
    -------
    dict
        name, gonio (version that wrote it), provenance, error: (side, component) to relative L1 error of each
        channel.

    Raises
    ------
    FormatError, OSError
        As `read_compact`.
    """
    attributes, variables = _opened(Path(path))
    errors = {}
    for side in SIDES:
        for component in COMPONENTS:
            found = variables.get(f"{side}_{component}")
            if found is not None and "error" in found[2]:
                errors[side, component] = np.atleast_1d(found[2]["error"]).tolist()
    return {
        "name": attributes.get("name", ""),
        "gonio": attributes.get("gonio", ""),
        "provenance": json.loads(attributes.get("provenance", "{}")),
        "error": errors,
    }


def _content(model: Compact, *, name: str, provenance: dict[str, Any]) -> bytes:
    errors = model.report.get("error", {})
    attributes: dict[str, Any] = {
        "title": f"compact BSDF model of {name or 'an unnamed material'}",
        "Conventions": "CF-1.11",
        "format": COMPACT_FORMAT,
        "format_version": np.int32(VERSION),
        "gonio": _native.__version__,
        "name": name,
        "channels": " ".join(model.channels),
        "energy_conserving": np.int32(model.properties["energy_conserving"]),
        "provenance": json.dumps(provenance, default=str),
    }
    variables: dict[str, Variable] = {}
    for part in model.parts():
        key = f"{part['side']}_{part['component']}"
        coded = part["coded"]
        about: dict[str, Any] = {
            "long_name": _LOG,
            "units": "1",
            "symmetry": part["symmetry"],
            "shape": np.array(part["shape"], dtype=np.int32),
            "lengths": np.array([len(one["bytes"]) for one in coded], dtype=np.int32),
            "width": np.array(part["width"], dtype=np.float64),
            "phi_x": np.float64(part["phi_x"]),
            "base": json.dumps(part["base"]),
        }
        if (part["side"], part["component"]) in errors:
            about["error"] = np.array(errors[part["side"], part["component"]], dtype=np.float64)
        codes = np.frombuffer(b"".join(one["bytes"] for one in coded), dtype=np.int8)
        variables[key] = ((f"{key}_bytes",), codes, about)
        rows = {len(one["step"]) for one in coded}
        for word in ("offset", "step"):
            if rows == {1}:
                values = np.array([one[word][0] for one in coded], dtype=np.float32)
                variables[f"{key}_{word}"] = (("channel",), values, {"units": "1"})
            else:
                variables[f"{key}_{word}"] = (("channel", f"{key}_theta_i"), part[word], {"units": "1"})
    for part in model.ideal_parts():
        key = f"{part['side']}_{part['component']}_unscattered"
        variables[key] = (
            ("channel", f"{key}_theta_i", f"{key}_phi_i"),
            part["shares"],
            {
                "long_name": "share of the light that is mirrored or passes straight through",
                "units": "1",
                "symmetry": part["symmetry"],
                "phi_x": np.float64(part["phi_x"]),
            },
        )
    return _signed(attributes, variables)


def _signed(attributes: Mapping[str, Any], variables: Mapping[str, Variable]) -> bytes:
    """The bytes of a file with these attributes and variables and its checksum."""
    from scipy.io import netcdf_file  # noqa: PLC0415  (a tenth of a second that most verbs do not need)

    buffer = io.BytesIO()
    file = netcdf_file(buffer, "w", version=2)
    for key, value in {**attributes, "checksum": f"sha256:{_NO_DIGEST.decode()}"}.items():
        setattr(file, key, _stored(value))
    for dims, values, _ in variables.values():
        for dim, length in zip(dims, values.shape, strict=True):
            if dim not in file.dimensions:
                file.createDimension(dim, length)
    for key, (dims, values, about) in variables.items():
        variable = file.createVariable(key, values.dtype, dims)
        variable[:] = values
        for word, value in about.items():
            setattr(variable, word, _stored(value))
    file.flush()
    content = buffer.getvalue()
    found = _CHECKSUM.search(content)
    assert found is not None
    at = slice(*found.span(1))
    return content[: at.start] + _digest(content, at) + content[at.stop :]


def _stored(value: Any) -> Any:
    """Text as UTF-8: left to itself scipy writes ASCII alone."""
    return value.encode("utf-8") if isinstance(value, str) else value


def _digest(content: bytes, at: slice) -> bytes:
    """SHA-256 of the file with zeros in place of the digest itself, in hexadecimal."""
    return hashlib.sha256(content[: at.start] + _NO_DIGEST + content[at.stop :]).hexdigest().encode()


def _opened(path: Path) -> Opened:
    """Attributes and variables of a whole file of this format and version."""
    from scipy.io import netcdf_file  # noqa: PLC0415

    content = path.read_bytes()
    if not content.startswith(MAGIC):
        raise FormatError(f"{path}: found no netCDF 3 file, allowed {COMPACT_FORMAT}")
    try:
        with netcdf_file(io.BytesIO(content), "r", mmap=False) as file:
            attributes = {key: _plain(value) for key, value in file._attributes.items()}
            variables = {
                key: (
                    tuple(variable.dimensions),
                    np.array(variable[:], dtype=variable[:].dtype.newbyteorder("=")),
                    {word: _plain(value) for word, value in variable._attributes.items()},
                )
                for key, variable in file.variables.items()
            }
    except Exception as error:
        # What scipy raises on a file that was cut or overwritten depends on where.
        raise FormatError(f"{path}: found a damaged netCDF file, allowed a whole one") from error
    if attributes.get("format") != COMPACT_FORMAT:
        found = attributes.get("format", "none")
        raise FormatError(f"{path}: format: found {found}, allowed {COMPACT_FORMAT}")
    version = attributes.get("format_version")
    if not isinstance(version, int) or version < 1:
        raise FormatError(f"{path}: format_version: found {version}, allowed 1 to {VERSION}")
    if version > VERSION:
        raise FormatError(
            f"{path}: format_version: found {version}, allowed 1 to {VERSION}: a newer gonio wrote it "
            f"({attributes.get('gonio', 'version not stated')}), update gonio to read it"
        )
    stated = _CHECKSUM.search(content)
    if stated is None or stated[1] != _digest(content, slice(*stated.span(1))):
        raise FormatError(f"{path}: checksum: the file is damaged or was changed; write it anew")
    attributes.pop("checksum", None)
    return attributes, variables


def _model(path: Path, opened: Opened) -> Compact:
    attributes, variables = opened
    parts, ideal = [], []
    for side in SIDES:
        for component in COMPONENTS:
            key = f"{side}_{component}"
            try:
                if key in variables:
                    stored = _plain_table if attributes["format_version"] == 1 else _coded_table
                    about = variables[key][2]
                    parts.append(
                        {
                            "side": side,
                            "component": component,
                            "symmetry": about["symmetry"],
                            "width": np.asarray(about["width"], dtype=np.float64).tolist(),
                            "phi_x": float(about["phi_x"]),
                            "base": json.loads(about["base"]),
                            **stored(key, variables),
                        }
                    )
                if f"{key}_unscattered" in variables:
                    _, shares, about = variables[f"{key}_unscattered"]
                    ideal.append(
                        {
                            "side": side,
                            "component": component,
                            "symmetry": about["symmetry"],
                            "phi_x": float(about["phi_x"]),
                            "shares": shares,
                        }
                    )
            except KeyError as error:
                raise FormatError(f"{path}: {key}: found no {error.args[0]}, needed for its table") from error
            except (TypeError, ValueError) as error:
                raise FormatError(f"{path}: {key}: {error}") from error
    try:
        return _native.compact_of(
            attributes["channels"].split(),
            parts,
            energy_conserving=bool(attributes["energy_conserving"]),
            ideal=ideal,
        )
    except KeyError as error:
        raise FormatError(f"{path}: found no {error.args[0]}") from error
    except (DomainError, TypeError, ValueError) as error:
        raise FormatError(f"{path}: {error}") from error


def _plain_table(key: str, variables: Mapping[str, Variable]) -> dict[str, Any]:
    """Codes one by one, as version 1 has them."""
    return {
        "codes": variables[key][1],
        "offset": variables[f"{key}_offset"][1],
        "step": variables[f"{key}_step"][1],
    }


def _coded_table(key: str, variables: Mapping[str, Variable]) -> dict[str, Any]:
    """Shape and coded channels."""
    _, codes, about = variables[key]
    lengths = np.atleast_1d(about["lengths"]).tolist()
    if sum(lengths) != codes.size or min(lengths) < 0:
        raise ValueError(f"lengths: found {lengths}, needed a sum of {codes.size}")
    whole, start, coded = codes.tobytes(), 0, []
    rows = {word: variables[f"{key}_{word}"][1] for word in ("offset", "step")}
    for channel, length in enumerate(lengths):
        one = {word: np.atleast_1d(values[channel]) for word, values in rows.items()}
        coded.append({"bytes": whole[start : start + length], **one})
        start += length
    return {"shape": np.asarray(about["shape"]).tolist(), "coded": coded}


def _plain(value: Any) -> Any:
    """Text as str, single numbers as Python's, arrays in the byte order of the machine."""
    if isinstance(value, bytes):
        return value.decode("utf-8")
    array = np.asarray(value)
    if array.size == 1:
        return array.reshape(()).item()
    return array.astype(array.dtype.newbyteorder("="))
