"""From raw readings to a measurement: dark, beam power, DSF, uncertainty, weights, integrals."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any, TypeAlias

from gonio import _native
from gonio._native import DomainError, MeasurementData, QuantityError, Scan
from gonio.campaigns import beam_for_each, idle_beam, one_sample, repeated_incidences
from gonio.files import check_directory
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.provenance import input_file, provenance
from gonio.readings import PathLike, read_file
from gonio.working import Progress, interruptible, silent

Source: TypeAlias = PathLike | Iterable[PathLike | Scan]
"""A path, or paths and scans in any mixture; `Readings` is such a list."""

KINDS = ("sample", "beam", "dark", "standard")


def process(
    files: Source,
    *,
    beam: Source | None = None,
    dark: Source | None = None,
    standard: Source | None = None,
    standard_reflectance: float | None = None,
    u_standard: float = 0.0,
    align: bool = False,
    format: str | None = None,
    columns: Mapping[str, str] | None = None,
    quantity: str | None = None,
    channel: str | None = None,
    upphi: float | None = None,
    dark_method: str = "auto",
    dark_tolerance: float = 0.25,
    noise_readout: float | None = None,
    noise_relative: float | None = None,
    u_angle: float = 0.0,
    u_calibration: float = 0.0,
    shadow_radius: float | None = None,
    name: str | None = None,
    out: PathLike | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> Measurement:
    """Process raw readings of a sample to DSF and BSDF with their uncertainty.

    Raw signals are freed of the dark reading and divided by the beam power of the reference scan. Values that
    are a BSDF, DSF or reflectance factor already are kept and need no reference scan. With `standard` the
    signals are divided by those of a calibrated standard instead.

    Parameters
    ----------
    files
        Files or scans of the sample. Reference and dark scans among them are used as such.
    beam
        Reference scan of the bare beam, of the same channel as the sample.
    dark
        Dark readings, or a blank scanned over the directions of the sample.
    standard
        Scans of a calibrated standard over the directions of the sample, in place of `beam`.
    standard_reflectance
        Reflectance factor of the standard; needed with `standard`.
    u_standard
        Relative standard uncertainty of `standard_reflectance`, as a fraction.
    align
        Turn the result into the frame of the sample's true normal, estimated from the mirror peaks. The
        estimate is in `provenance["processing"]["alignment"]` in any case, None where the data do not tell.
    format, columns, quantity, channel, upphi
        What the files do not tell, as in `gonio.read`; `quantity` does not hold for `beam`.
    dark_method
        How dark readings are assigned: direction, time, level, or auto.
    dark_tolerance
        Largest angle in degrees between a reading and its blank reading.
    noise_readout
        Standard deviation of the read-out noise, unit of the readings, in place of what the files state.
    noise_relative
        Standard deviation of the noise proportional to the signal, as a fraction.
    u_angle
        Standard uncertainty of each receiver direction, degrees.
    u_calibration
        Relative standard uncertainty common to all values beyond that of the beam power, as a fraction.
    shadow_radius
        Readings within this angle of the retro direction lie in the detector's shadow, degrees; None takes it
        from the apertures where they are known.
    name
        Name of the sample in place of the one in the files; files that name different samples need it.
    out
        Directory to save the measurement to; it is checked before the work and appears whole or not at all.
    force
        Write into a directory that holds other files.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    FormatError
        A file does not follow its format, or `out` holds other files.
    QuantityError
        Mixed quantities or samples; a reference scan that is missing or of another channel.
    DomainError
        A value or option outside its range; an empty scan.
    OSError
        The operating system refuses.
    """
    if out is not None:
        check_directory(out, marker=JSON_NAME, force=force)
    sources = {"sample": files, "beam": beam, "dark": dark, "standard": standard}
    told = {"format": format, "columns": columns, "channel": channel, "upphi": upphi}
    scans, inputs = _gather(sources, told, quantity, progress)
    settings: dict[str, Any] = {
        "dark_method": dark_method,
        "dark_tolerance": dark_tolerance,
        "noise_readout": noise_readout,
        "noise_relative": noise_relative,
        "u_angle": u_angle,
        "u_calibration": u_calibration,
        "shadow_radius": shadow_radius,
    }
    relative = {"standard_reflectance": standard_reflectance, "u_standard": u_standard}
    if name is None:
        one_sample(scans["sample"])
    if not scans["standard"]:
        beam_for_each(scans["sample"], scans["beam"])
    notes = [*repeated_incidences(scans["sample"]), *idle_beam(scans["sample"], scans["beam"])]
    progress("processing", 0, 1)
    data = interruptible(lambda: _compute(scans, relative, settings))
    if name is not None or notes:
        data = data.annotated(sample_name=name, warnings=notes)
    alignment = _alignment(data)
    if align:
        data = interruptible(lambda: _native.correct_alignment(data))
    progress("processing", 1, 1)
    origin = provenance(
        inputs=inputs,
        settings={**told, "quantity": quantity, **settings, **relative, "align": align, "name": name},
    )
    found = {**data.processing, "alignment": alignment}
    measurement = Measurement._wrap(
        data, provenance={**origin, **_recorded(scans["sample"]), "processing": found}
    )
    if out is not None:
        progress("saving", 0, 1)
        measurement.save(out, force=force)
        progress("saving", 1, 1)
    return measurement


def _compute(
    scans: Mapping[str, list[Scan]], relative: Mapping[str, Any], settings: Mapping[str, Any]
) -> MeasurementData:
    """Result of the absolute route, or of the relative one when there are scans of a standard."""
    if not scans["standard"]:
        if relative["standard_reflectance"] is not None:
            raise QuantityError("standard: found a reflectance factor without a scan, needed both")
        return _native.process(scans["sample"], beam=scans["beam"], dark=scans["dark"], **settings)
    if scans["beam"]:
        raise QuantityError("reference: found scans of the beam and of a standard, needed one of the two")
    if relative["standard_reflectance"] is None:
        raise QuantityError("standard_reflectance: found none, needed the standard's reflectance factor")
    return _native.process_relative(
        scans["sample"],
        standard=scans["standard"],
        reflectance_factor=[relative["standard_reflectance"]],
        u_standard=relative["u_standard"],
        dark=scans["dark"],
        **settings,
    )


def _recorded(scans: Iterable[Scan]) -> dict[str, str]:
    """Instrument and earliest start of the sample's scans, as far as their files tell."""
    meta = [scan.meta for scan in scans]
    instruments = dict.fromkeys(str(m["instrument"]) for m in meta if m.get("instrument"))
    starts = sorted(str(m["started"]) for m in meta if m.get("started"))
    found = {"instrument": ", ".join(instruments), "started": starts[0] if starts else ""}
    return {key: value for key, value in found.items() if value}


def _alignment(data: MeasurementData) -> dict[str, float] | None:
    """Tilt and azimuth offset in degrees; None where the mirror peaks do not tell."""
    try:
        return interruptible(lambda: _native.align(data))
    except (DomainError, QuantityError):
        return None


def _gather(
    sources: Mapping[str, Source | None],
    told: Mapping[str, Any],
    quantity: str | None,
    progress: Progress,
) -> tuple[dict[str, list[Scan]], list[dict[str, Any]]]:
    """Scans by kind, and the files they came from with their hashes."""
    items = [(role, item) for role, source in sources.items() for item in _items(source)]
    scans: dict[str, list[Scan]] = {kind: [] for kind in KINDS}
    inputs: list[dict[str, Any]] = []
    for done, (role, item) in enumerate(items):
        progress("reading", done, len(items))
        if isinstance(item, Scan):
            found = [item]
        else:
            inputs.append(interruptible(lambda path=item, role=role: input_file(path, role=role)))  # type: ignore[misc]
            found = interruptible(lambda path=item, role=role: _read(path, role, told, quantity))  # type: ignore[misc]
        for scan in found:
            if role not in ("sample", scan.kind):
                name = scan.meta.get("source", "scan")
                raise QuantityError(f"{name}: kind: found {scan.kind}, needed {role}")
            scans[scan.kind].append(scan)
    progress("reading", len(items), len(items))
    return scans, inputs


def _items(source: Source | None) -> list[PathLike | Scan]:
    if source is None:
        return []
    return [source] if isinstance(source, (str, os.PathLike)) else list(source)


def _read(path: PathLike, role: str, told: Mapping[str, Any], quantity: str | None) -> list[Scan]:
    """Scans of a file; files that do not tell their kind take it from their role."""
    return read_file(
        path,
        **told,
        kind=None if role == "sample" else role,
        quantity=None if role == "beam" else quantity,
    )[1]
