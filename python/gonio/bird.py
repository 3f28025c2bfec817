"""BRDF data as JSON, the universal format of the project BiRD (docs/formats/bird-json.md)."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from gonio import _native
from gonio._native import FormatError, QuantityError, Scan, __version__
from gonio.files import replacing_file
from gonio.measurement import Measurement

FORMAT = "bird-json"
SCHEMA = (
    "https://raw.githubusercontent.com/BiRD-project/BiRD_view/master/BRDF_JSON_schema/"
    "brdf_json_schema_v1.0.json"
)

_ANGLES = ("theta_i", "phi_i", "theta_r", "phi_r")
_UNITS = {
    **{name: {"deg": 1.0, "°": 1.0, "rad": 180.0 / math.pi} for name in _ANGLES},
    "BRDF": {"1/sr": 1.0, "sr^-1": 1.0, "sr-1": 1.0},
    "wavelength_i": {"nm": 1.0, "μm": 1000.0, "µm": 1000.0},
    "wavelength_r": {"nm": 1.0, "μm": 1000.0, "µm": 1000.0},
}
_IGNORED = ("BRDF", "uBRDF", *_ANGLES, "wavelength_i", "wavelength_r")

Array = npt.NDArray[Any]


def read(
    path: str | os.PathLike[str],
    *,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
) -> list[Scan]:
    """Scans of a file, one an incidence and wavelength, readings in the order of the file.

    Parameters
    ----------
    path
        The file: version 1.0 of the schema (an object a variable) or the layout before it (a list of
        variables and a table of values).
    kind
        `sample` unless given.
    quantity
        `bsdf`, which is what the file holds.
    channel
        For files without wavelengths; of the others it takes one out.

    Raises
    ------
    FormatError
        The file is no such JSON, lacks a variable, has another unit or length, or varies something that a
        scan cannot keep apart (polarization).
    QuantityError
        Another quantity, no channel where the file has no wavelength, or one that it does not have.
    OSError
        The operating system refuses.
    """
    if quantity not in (None, "bsdf"):
        raise QuantityError(f"quantity: found {quantity}, needed bsdf, which the file holds")
    document = _document(Path(path))
    variables = _variables(path, document["data"])
    numbers = {name: _numbers(path, name, variables) for name in (*_ANGLES, "BRDF")}
    for name, low, high in (
        ("theta_i", 0, 90),
        ("theta_r", 0, 90),
        ("phi_i", -360, 720),
        ("phi_r", -360, 720),
    ):
        bad = ~((numbers[name] >= low) & (numbers[name] <= high))
        if bad.any():
            k = int(np.argmax(bad))
            raise FormatError(
                f"{path}: {name} of value {k + 1}: found {numbers[name][k]}, allowed {low} to {high} degrees"
            )
    _refuse_varied(path, variables)
    wavelength = _wavelengths(path, variables)
    size = len(numbers["BRDF"])
    if wavelength is None:
        if channel is None:
            raise QuantityError(f"{path}: channel: found no wavelength, needed channel=")
        names: Array = np.full(size, channel)
    else:
        distinct, which = np.unique(wavelength, return_inverse=True)
        names = np.array([f"{nm:.12g}nm" for nm in distinct.tolist()])[which]
        if channel is not None:
            if channel not in names:
                known = ", ".join(dict.fromkeys(names.tolist()))
                raise QuantityError(f"{path}: channel: found {channel}, needed one of {known}")
            chosen = names == channel
            names, numbers = names[chosen], {name: values[chosen] for name, values in numbers.items()}
    keys = np.rec.fromarrays([names, numbers["theta_i"], numbers["phi_i"]])
    _, first, group = np.unique(keys, return_index=True, return_inverse=True)
    meta = _meta(path, document["metadata"])
    scans = []
    for k in np.argsort(first):
        here = group.ravel() == k
        at = first[k]
        scans.append(
            Scan(
                kind=kind or "sample",
                quantity="bsdf",
                channel=str(names[at]),
                theta_i=float(numbers["theta_i"][at]),
                phi_i=float(numbers["phi_i"][at]),
                theta_s=numbers["theta_r"][here],
                phi_s=numbers["phi_r"][here],
                value=numbers["BRDF"][here],
                meta=meta,
            )
        )
    return scans


def write(path: str | os.PathLike[str], measurement: Measurement) -> list[str]:
    """Write the reflection of a measurement on its front as version 1.0 of the schema; returns what to tell.

    One value a usable reading with its standard uncertainty. The schema has no negative BRDF, no transmission
    and no channel but wavelengths: negative readings are left out and counted, transmission is left out.

    Raises
    ------
    FormatError
        A channel that is no wavelength among several channels, or no reading that the format can hold.
    OSError
        The operating system refuses; nothing is left behind.
    """
    channels = measurement.channels
    spectral = all(c.endswith("nm") for c in channels)
    if not spectral and len(channels) > 1:
        raise FormatError(
            f"{path}: channel: found {', '.join(channels)}, allowed wavelengths, or one channel"
        )
    columns: dict[str, list[Array]] = {name: [] for name in (*_ANGLES, "BRDF", "uBRDF", "wavelength_i")}
    negative = 0
    for s in measurement.slices:
        cosine = np.cos(np.radians(s.theta_s))
        usable = ((s.flags & _native.UNUSABLE) == 0) & (s.theta_s < 90.0 - 1e-6) & (s.theta_i < 90.0)
        negative += int(np.count_nonzero(usable & (s.dsf < 0)))
        usable &= s.dsf >= 0
        count = int(np.count_nonzero(usable))
        columns["theta_i"].append(np.full(count, s.theta_i))
        columns["phi_i"].append(np.full(count, s.phi_i))
        columns["theta_r"].append(s.theta_s[usable])
        columns["phi_r"].append(s.phi_s[usable])
        columns["BRDF"].append((s.dsf / cosine)[usable])
        columns["uBRDF"].append((s.u_dsf / cosine)[usable])
        if spectral:
            columns["wavelength_i"].append(np.full(count, float(s.channel.removesuffix("nm"))))
    joined = {name: np.concatenate(parts) if parts else np.empty(0) for name, parts in columns.items()}
    if not len(joined["BRDF"]):
        raise FormatError(f"{path}: readings: found none in reflection on the front, allowed at least one")
    units = {**dict.fromkeys(_ANGLES, "deg"), "BRDF": "sr^-1", "uBRDF": "sr^-1", "wavelength_i": "nm"}
    data = {
        name: {"unit": units[name], "values": values.tolist()}
        for name, values in joined.items()
        if len(values) == len(joined["BRDF"])
    }
    notes = []
    if negative:
        notes.append(f"{negative} negative readings are left out: the format has none")
    if not spectral:
        notes.append(f"the channel, {channels[0]}, has no place in the format; it stands in a comment")
    document = {
        "metadata": {
            "schema": SCHEMA,
            "type": "BRDF",
            "timestamp": str(measurement.provenance.get("created", "NA")),
            "method": "measurement",
            "instrumentation": "NA",
            "software": {"name": "gonio", "version": __version__},
            "sample": {"name": measurement.sample_name or "NA"},
            "environment": "NA",
            "comments": "; ".join([f"channels: {', '.join(channels)}", *notes]),
        },
        "data": data,
    }
    with replacing_file(path) as staged:
        staged.write_text(json.dumps(document, ensure_ascii=False, allow_nan=False), encoding="utf-8")
    return notes


def _document(path: Path) -> dict[str, Any]:
    with path.open("rb") as file:
        content = file.read()
    try:
        document = json.loads(content.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise FormatError(f"{path}: file: found other than UTF-8, allowed JSON in UTF-8") from error
    except json.JSONDecodeError as error:
        raise FormatError(f"{path}, line {error.lineno}: JSON: found {error.msg}, allowed JSON") from error
    except RecursionError as error:
        raise FormatError(f"{path}: JSON: found too deep a nesting, allowed BRDF data") from error
    parts = ("metadata", "data")
    if not isinstance(document, dict) or not all(isinstance(document.get(p), dict) for p in parts):
        raise FormatError(f"{path}: file: found no objects metadata and data, allowed BRDF data of BiRD")
    return document


def _variables(path: str | os.PathLike[str], data: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """Variables by name, each with unit and values; the older layout is turned into the newer one."""
    if not isinstance(data.get("variables"), list):
        found = {name: v for name, v in data.items() if isinstance(v, dict) and name != "adhoc_variables"}
        adhoc = data.get("adhoc_variables", {})
        return found | (adhoc if isinstance(adhoc, dict) else {})
    variables, rows = data["variables"], data.get("values")
    if not isinstance(rows, list) or not all(isinstance(v, dict) and "name" in v for v in variables):
        raise FormatError(f"{path}: data: found no list of values or a variable without a name, allowed both")
    if set(map(type, rows)) - {list} or set(map(len, rows)) - {len(variables)}:
        whole = (isinstance(row, list) and len(row) == len(variables) for row in rows)
        k = next(k for k, good in enumerate(whole) if not good)
        found_length = f"{len(rows[k])} columns" if isinstance(rows[k], list) else repr(rows[k])[:40]
        raise FormatError(
            f"{path}: row {k + 1} of values: found {found_length}, allowed {len(variables)} columns"
        )
    columns = zip(*rows, strict=True) if rows else ([] for _ in variables)
    return {
        str(v["name"]): {**v, "values": list(column)} for v, column in zip(variables, columns, strict=True)
    }


def _numbers(path: str | os.PathLike[str], name: str, variables: Mapping[str, Mapping[str, Any]]) -> Array:
    """Values of a variable in degrees, 1/sr or nm."""
    variable = variables.get(name)
    if variable is None or not isinstance(variable.get("values"), list):
        raise FormatError(f"{path}: {name}: found no values, allowed a variable with unit and values")
    factor = _UNITS[name].get(str(variable.get("unit")))
    if factor is None:
        allowed = ", ".join(_UNITS[name])
        raise FormatError(f"{path}: {name}: found unit {variable.get('unit')!r}, allowed {allowed}")
    values = variable["values"]
    size = len(variables.get("BRDF", {}).get("values", ()))
    if len(values) != size or not values:
        raise FormatError(
            f"{path}: {name}: found {len(values)} values, allowed {size or 'at least one'}, as BRDF"
        )
    try:
        numbers = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise FormatError(f"{path}: {name}: found a value that is no number, allowed numbers") from error
    if numbers.ndim != 1 or not np.isfinite(numbers).all():
        raise FormatError(f"{path}: {name}: found a list or a number that is not finite, allowed numbers")
    return numbers * factor if factor != 1.0 else numbers


def _wavelengths(path: str | os.PathLike[str], variables: Mapping[str, Mapping[str, Any]]) -> Array | None:
    there = [n for n in ("wavelength_i", "wavelength_r") if n in variables]
    found = [np.round(_numbers(path, name, variables), 6) for name in there]
    if len(found) == 2 and not np.array_equal(found[0], found[1]):
        raise FormatError(f"{path}: wavelength_r: found others than in wavelength_i, allowed the same")
    return found[0] if found else None


def _refuse_varied(path: str | os.PathLike[str], variables: Mapping[str, Mapping[str, Any]]) -> None:
    """Refuse variables beside angle and wavelength that take more than one value."""
    for name, variable in variables.items():
        values = variable.get("values")
        if name in _IGNORED or not isinstance(values, list):
            continue
        if values and values.count(values[0]) < len(values):
            other = next(v for v in values if v != values[0])
            raise FormatError(
                f"{path}: {name}: found {json.dumps(values[0])}, {json.dumps(other)}, "
                "allowed one value in all of the file"
            )


def _meta(path: str | os.PathLike[str], metadata: Mapping[str, Any]) -> dict[str, Any]:
    def name_of(section: str) -> str | None:
        part = metadata.get(section)
        name = part.get("name") if isinstance(part, dict) else part
        return name if isinstance(name, str) and name and name != "NA" else None

    meta: dict[str, Any] = {"source": os.fspath(path)}
    for key, found in (("sample_name", name_of("sample")), ("instrument", name_of("instrumentation"))):
        if found:
            meta[key] = found
    started = metadata.get("timestamp")
    if isinstance(started, str) and started not in ("", "NA"):
        meta["started"] = started
    comments = metadata.get("comments")
    if isinstance(comments, str) and comments not in ("", "NA"):
        meta["other"] = {"comments": comments}
    return meta
