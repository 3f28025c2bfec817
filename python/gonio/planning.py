"""Plans of campaigns: the path that reaches given uncertainties with few readings."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gonio import _native
from gonio._native import DomainError
from gonio.files import check_directory, replacing_directory
from gonio.instrument_files import write_on_path
from gonio.instrument_spectra import outputs
from gonio.instruments import Instrument, read_instrument
from gonio.materials import MATERIALS, Component, Material, material, material_of_file
from gonio.measurement import Measurement
from gonio.planned_material import material_of_measurement, measurement_of_directory
from gonio.readings import PathLike
from gonio.simulated_path import PathOfScan, plot_path, write_path_table
from gonio.simulating import checked_instrument
from gonio.working import Progress, interruptible, silent

NOTEBOOK = "plan.json"
"""Name of the file that holds the forecast."""

FILES = ("instrument.toml", "path.csv", "path.png")
"""Names of the other files of a plan."""

UNSEEN = 1.5
"""Pitch over 1/e half width from which on a lobe is integrated with errors above 2.5 % of its flux:
2 exp(-(pi w / d)²)."""


@dataclass(frozen=True)
class PlannedLobe:
    """A refined lobe: its top, its 1/e half widths and the pitches at its top, along and across, degrees.

    `height` is its DSF as the instrument sees it, 1/sr; 0 for a region that was asked for.
    """

    at: tuple[float, float]
    width: tuple[float, float]
    pitch: tuple[float, float]
    height: float


@dataclass(frozen=True)
class PlannedScan:
    """Forecast of one incidence and hemisphere; uncertainties are relative and standard, angles degrees.

    `integral` is DHR or DHT as processing would give it, `u_integral` what it would claim, of which the path
    decides `u_quadrature`, `error` by how much it would be off. `peak` is the highest reading (1/sr) at
    `peak_at`, `u_peak` its claim as the height of the lobe, of which `u_sampling` comes from readings beside
    the top. With several detectors, each is to meet the targets; these figures are those of the least certain
    one: `channel_integral` of the integral, `channel_peak` of the peak. `u_common` is what calibration and
    scans of the beam leave of both. `flattened`: share by which
    beam and aperture lower the material's highest peak. `unread`: share of the hemisphere in the detector's
    shadow or beyond the last polar angle; `shaded` and `beyond`: shares of the light there. `base`: pitch
    away from lobes. `missed` says what keeps a target from being met: time, instrument (noise, calibration,
    width of the beam) or pitch (a denser path does not help); None where both are met.
    """

    theta_i: float
    phi_i: float
    component: Component
    readings: int
    seconds: float
    channel_integral: str
    integral: float
    error: float
    u_integral: float
    u_quadrature: float
    u_common: float
    channel_peak: str
    peak: float
    peak_at: tuple[float, float]
    u_peak: float
    u_sampling: float
    flattened: float
    shaded: float
    beyond: float
    unread: float
    base: float
    lobes: tuple[PlannedLobe, ...]
    missed: str | None


@dataclass(frozen=True)
class Plan:
    """A path with what it is expected to give and what it will miss.

    `path` holds where the detector reads, one entry an incidence, `seconds` the time of the whole campaign
    with dark records and scans of the beam, `misses` sentences. `settings` is what was asked, `channels` the
    detectors that meet it.
    """

    material: Material
    instrument: Instrument
    scans: tuple[PlannedScan, ...]
    path: tuple[PathOfScan, ...]
    readings: int
    seconds: float
    misses: tuple[str, ...]
    settings: Mapping[str, Any]
    channels: tuple[str, ...]

    @property
    def met(self) -> bool:
        """Whether all targets are met."""
        return all(s.missed is None for s in self.scans)

    def to_dict(self) -> dict[str, Any]:
        """Return the forecast as plain data."""
        return {
            "material": self.material.name,
            "description": self.material.description,
            "instrument": self.instrument.name,
            "settings": dict(self.settings),
            "channels": list(self.channels),
            "met": self.met,
            "readings": self.readings,
            "seconds": self.seconds,
            "scans": [asdict(s) for s in self.scans],
            "misses": list(self.misses),
        }

    def write(self, out: str | os.PathLike[str], *, force: bool = False) -> None:
        """Write a directory: `instrument.toml` with its path in `path.csv`, `path.png`, `plan.json`.

        `gonio.simulate` takes the instrument as it is. The directory appears whole or not at all.

        Raises
        ------
        FormatError
            `out` holds other files and `force` is not set.
        OSError
            The file system refuses.
        """
        with replacing_directory(out, marker=NOTEBOOK, owned=FILES, force=force) as staged:
            write_path_table(self.path, out=staged / "path.csv")
            write_on_path(self.instrument, table="path.csv", out=staged / "instrument.toml")
            plot_path(self.path, out=staged / "path.png")
            text = json.dumps(self.to_dict(), indent=2) + "\n"
            (staged / NOTEBOOK).write_text(text, encoding="utf-8")


def plan(
    known: PathLike | Material | Measurement,
    *,
    instrument: PathLike | Instrument = "pgII-like",
    settings: Mapping[str, float] | None = None,
    incidences: Sequence[tuple[float, float]] | None = None,
    components: Sequence[Component] | None = None,
    target_dhr: float = 0.005,
    target_peak: float = 0.01,
    minutes: float | None = None,
    largest_pitch: float = 10.0,
    regions: Sequence[tuple[float, float, float, float]] = (),
    beam_scans: int = 3,
    seed: int = 1,
    out: str | os.PathLike[str] | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> Plan:
    """Plan the path that measures DHR or DHT and peak to target uncertainties with few readings.

    Over what the instrument would see of the material the lobes are found with their widths along and across.
    Rings of a coarse base are laid over each hemisphere and lines over each lobe, densest at its top, across
    its ridge, and as much closer together across the plane of incidence as lobes are narrower there. The path
    is measured with the virtual instrument and processed, and refined where that helps most for the readings
    it costs (docs/plan.md). Of several detectors that read at once every one is to meet the targets.

    Parameters
    ----------
    known
        What is known of the material: the name of one (`gonio.materials.MATERIALS`), a `Material`, a file of
        a model, a measurement or the directory of one, or a directory of raw files as `gonio.simulate` writes
        them: a fast scan. Of readings the best analytic model of `gonio.fit` is planned for.
    instrument
        File, preset or `Instrument`; of its path `theta_max` counts.
    settings
        Numbers in place of its own, as in `gonio.simulate`.
    incidences
        (theta_i, phi_i) in degrees; None takes the material's or the measurement's.
    components
        Hemispheres; None takes what the material scatters into or what was measured.
    target_dhr, target_peak
        Relative standard uncertainties, more than 0 and less than 1: of every DHR and DHT, and of the highest
        reading of every hemisphere as the height of its lobe.
    minutes
        Time that the whole campaign may take, dark records and scans of the beam included.
    largest_pitch
        Pitch of the base at most, .3 to 28 degrees: a lobe that is not known is found only if it is wider.
    regions
        (theta_s, phi_s, radius, pitch) in degrees: what is read whatever is known.
    beam_scans
        Number of reference scans of the bare beam, 1 to 100.
    seed
        Seed of phases of the path and of noise; the same seed gives the same path.
    out, force
        Directory to write the plan to, as `Plan.write` does.
    progress
        Called with stage, rounds done and rounds there may be.

    Raises
    ------
    DomainError
        A target, time, pitch or region out of range, a time that the coarsest path exceeds, an incidence out
        of reach, readings that cannot be fitted.
    FormatError
        A file that is wrong, or `out` holds other files.
    OSError
        The file system refuses.
    """
    if out is not None:
        check_directory(out, marker=NOTEBOOK, force=force)
    if not 0 <= seed < 2**64:
        raise DomainError(f"seed: found {seed}, allowed 0 to 2**64 - 1")
    _check_targets(target_dhr=target_dhr, target_peak=target_peak)
    if minutes is not None and not minutes > 0.0:
        raise DomainError(f"minutes: found {minutes:g}, allowed more than 0")
    if not 0.3 <= largest_pitch <= 28.0:
        raise DomainError(f"largest_pitch: found {largest_pitch:g}, allowed .3 to 28 degrees")
    for region in regions:
        _check_region(region)
    device = instrument if isinstance(instrument, Instrument) else read_instrument(instrument)
    target, notes = _known(known, progress)
    device = device.with_settings({name: float(value) for name, value in (settings or {}).items()})
    angles = [(float(t), float(p)) for t, p in (target.incidences if incidences is None else incidences)]
    hemispheres = list(target.components if components is None else components)
    device.reaches(angles)
    parts = {k: v for k, v in device.parts.items() if k not in ("regions", "prescan", "planes", "table")}
    if device.channels and device.lamp is not None:
        parts["outputs"] = outputs(device.channels, lamp=device.lamp, of=target.bsdf.channels)
    found = checked_instrument(
        device,
        lambda: _native.plan(
            target.bsdf,
            incidences=angles,
            components=hemispheres,
            seed=seed,
            settings=dict(device.settings),
            parts=parts,
            beam_scans=beam_scans,
            target_integral=float(target_dhr),
            target_peak=float(target_peak),
            seconds=None if minutes is None else 60.0 * float(minutes),
            largest_pitch=float(largest_pitch),
            u_calibration=device.u_calibration,
            regions=[(float(t), float(p) % 360.0, float(r), float(d)) for t, p, r, d in regions],
            watch=lambda done, total: progress("planning", done, total),
        ),
    )
    scans = tuple(_scan(row) for row in found["scans"])
    asked = {
        "target_dhr": target_dhr,
        "target_peak": target_peak,
        "minutes": minutes,
        "largest_pitch": largest_pitch,
        "regions": [list(r) for r in regions],
        "incidences": [list(a) for a in angles],
        "components": hemispheres,
        "seed": seed,
    }
    result = Plan(
        material=target,
        instrument=device,
        scans=scans,
        path=tuple(
            PathOfScan(t, p, theta, phi, np.full(len(theta), np.nan)) for t, p, theta, phi in found["table"]
        ),
        readings=found["readings"],
        seconds=found["seconds"],
        misses=(
            *notes,
            *misses(
                scans, target_dhr=target_dhr, target_peak=target_peak, several=len(found["channels"]) > 1
            ),
        ),
        settings=asked,
        channels=tuple(found["channels"]),
    )
    if out is not None:
        result.write(out, force=force)
    return result


def _check_targets(**targets: float) -> None:
    for name, value in targets.items():
        if not 0.0 < value < 1.0:
            raise DomainError(f"{name}: found {value:g}, allowed more than 0, less than 1")


def _check_region(region: tuple[float, float, float, float]) -> None:
    theta, phi, radius, pitch = region
    if not (0.0 <= theta <= 180.0 and -360.0 <= phi <= 360.0):
        raise DomainError(
            f"regions: found theta_s = {theta:g}, phi_s = {phi:g}, outside of the sphere, allowed theta_s 0 "
            "to 180, phi_s -360 to 360"
        )
    if not (0.1 <= radius <= 90.0 and 0.012 <= pitch <= 28.0):
        raise DomainError(
            f"regions: found radius {radius:g}, pitch {pitch:g}, allowed .1 to 90 and .012 to 28 degrees"
        )


def _known(known: PathLike | Material | Measurement, progress: Progress) -> tuple[Material, list[str]]:
    """The material to plan for, and what is to be said of how well it is known."""
    if isinstance(known, Material):
        return known, []
    if isinstance(known, Measurement):
        return material_of_measurement(known, progress=progress)
    place = Path(known)
    if place.is_dir():
        return material_of_measurement(measurement_of_directory(place, progress=progress), progress=progress)
    if str(known) not in MATERIALS and place.is_file():
        return interruptible(lambda: material_of_file(place)), []
    return material(str(known)), []


def _scan(row: Mapping[str, Any]) -> PlannedScan:
    lobes = tuple(PlannedLobe(at, tuple(width), tuple(pitch), h) for at, width, pitch, h in row["lobes"])
    return PlannedScan(**{**row, "lobes": lobes})


WHY = {
    "time": "the time is used up",
    "instrument": "noise, calibration and the width of the beam decide, not the path",
    "pitch": "a denser path does not help: light goes where the detector cannot read",
}


def misses(
    scans: Sequence[PlannedScan], *, target_dhr: float, target_peak: float, several: bool = False
) -> list[str]:
    """Return sentences on what a planned path will miss; of `several` detectors they name the one meant."""
    found = []
    for s in scans:
        place = f"theta_i {s.theta_i:g}°, phi_i {s.phi_i:g}°, {s.component}"
        name = "DHR" if s.component == "reflection" else "DHT"
        by, of = (f" ({c})" if several else "" for c in (s.channel_integral, s.channel_peak))
        over = []
        if max(s.u_integral, s.error) > target_dhr:
            over.append(f"{name} to {max(s.u_integral, s.error):.2%} instead of {target_dhr:.2%}{by}")
        if s.u_peak > target_peak:
            over.append(f"peak to {s.u_peak:.2%} instead of {target_peak:.2%}{of}")
        if s.missed is not None:
            found.append(f"{place}: {', '.join(over) or 'a target'}: {WHY[s.missed]}")
    flat = max(scans, key=lambda s: s.flattened, default=None)
    if flat is not None and flat.flattened >= 0.1 * target_peak:
        found.append(
            f"beam and aperture flatten peaks by up to {flat.flattened:.2%} (theta_i {flat.theta_i:g}°, "
            f"{flat.component})"
        )
    dark = max(scans, key=lambda s: s.shaded + s.beyond, default=None)
    if dark is not None and dark.shaded + dark.beyond >= 0.1 * target_dhr:
        shadow = f"{dark.shaded:.2%} in the shadow of the detector, " if dark.shaded > 0.0 else ""
        found.append(
            f"{dark.unread:.1%} of a hemisphere is not read, and with it up to "
            f"{dark.shaded + dark.beyond:.2%} of the light ({shadow}{dark.beyond:.2%} beyond the last "
            f"theta_s; theta_i {dark.theta_i:g}°, {dark.component}): it is extrapolated"
        )
    if scans:
        low, high = min(s.base for s in scans), max(s.base for s in scans)
        pitch = f"{high:.1f}°" if high - low < 0.05 else f"{low:.1f}° to {high:.1f}°"
        found.append(
            f"away from the refined lobes readings are {pitch} apart: lobes that are not known and narrower "
            f"than {high / UNSEEN:.1f}° (1/e half width) are integrated with errors above 2.5 % of their "
            "light, or not seen"
        )
    return found
