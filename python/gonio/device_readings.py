"""Raw readings of parts that exist as geometry, by ray tracing through the virtual goniophotometer."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from gonio import _native
from gonio._native import DomainError
from gonio.devices import open_device
from gonio.instruments import Instrument
from gonio.materials import Component
from gonio.readings import PathLike
from gonio.simulated_path import PathOfScan, paths_of
from gonio.simulating import STARTED, checked_instrument, described, set_up, write_campaign
from gonio.working import Progress, silent

CHANNELS = ("red", "green", "blue")
"""Channels of geometry; an instrument without channels of its own sees the luminance."""

INCIDENCES = ((8.0, 0.0), (30.0, 0.0), (60.0, 0.0))
"""Incidences unless told otherwise, degrees."""


@dataclass(frozen=True)
class MonteCarlo:
    """How well the readings of one path over the sample are known.

    `joined` scatterings were joined with the readings, `met` rays were looked for in the apertures;
    `median` and `worst` are standard errors over the noise of the reading, `above` the share of readings
    where that is more than asked for.
    """

    joined: int
    met: int
    median: float
    worst: float
    above: float


@dataclass(frozen=True)
class GeometryCampaign:
    """Raw files of a campaign over geometry in the directory `out`.

    `monte_carlo` says how well each path over the sample is known, prescans included, in the order they were
    taken; `campaign.json` keeps it.
    """

    name: str
    seed: int
    out: Path
    sample: tuple[Path, ...]
    beam: tuple[Path, ...]
    dark: tuple[Path, ...]
    readings: int
    monte_carlo: tuple[MonteCarlo, ...]
    instrument: Instrument | None = None
    path: tuple[PathOfScan, ...] = ()
    warnings: list[str] = field(default_factory=list)


def simulate_readings(
    *files: PathLike,
    out: str | os.PathLike[str],
    window: Sequence[float] | None = None,
    periodic: bool = False,
    unit: float = 1.0,
    seed: int = 1,
    incidences: Sequence[tuple[float, float]] = INCIDENCES,
    components: Sequence[Component] = ("reflection",),
    instrument: PathLike | Instrument | Mapping[str, float] | None = None,
    settings: Mapping[str, float] | None = None,
    beam_scans: int = 3,
    share: float = 0.5,
    joined: int = 2**14,
    met: int = 2**22,
    search: Sequence[PathLike] | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> GeometryCampaign:
    """Measure a part that is geometry with the virtual goniophotometer and write its raw files.

    The files are those of `gonio.simulate`, processed like a recording. The middle of the window lies on the
    axis of the beam, the plane z = 0 of the geometry on the axes of the holder. Rays go from the lit spot
    through the part; of where they are scattered, some that stand for all are joined with every aperture.
    What is mirrored, refracted or goes straight is found from the beam and from the apertures. Rays are added
    until the Monte-Carlo part of a reading is below a share of its noise.

    Parameters
    ----------
    files, window, periodic, search
        As for `simulate_geometry`. Light is taken to leave a periodic part where it fell on it.
    out, force, seed, beam_scans, progress
        As for `gonio.simulate`.
    unit
        Metres of a unit of the geometry, 1e-9 to 1000.
    incidences
        (theta_i, phi_i) in degrees; above 90 the back is lit.
    components
        Hemispheres to scan, of "reflection" and "transmission".
    instrument, settings
        As for `gonio.simulate`. Without channels of its own the detector records the luminance as photopic.
    share
        Largest standard error of a reading over its noise, above 0, at most 1.
    joined, met
        At most for an incidence: scatterings joined with the readings, which stand for those of 64 times as
        many rays (1 to 2**24), and rays looked for in the apertures (1 to 2**30). What they do not reach is
        in `GeometryCampaign.monte_carlo`.

    Returns
    -------
    GeometryCampaign

    Raises
    ------
    DomainError
        As `gonio.simulate`; a part that does not repeat and is smaller than the spot, without `overfill`; a
        period larger than the spot.
    FormatError, OSError
        As `read_scene` and `gonio.simulate`.
    """
    if not 0 <= seed < 2**64:
        raise DomainError(f"seed: found {seed}, allowed 0 to 2**64 - 1")
    for name, rays, most in (("joined", joined, 24), ("met", met, 30)):
        if not 1 <= rays <= 2**most:
            raise DomainError(f"{name}: found {rays}, allowed 1 to 2**{most}")
    part, warnings = open_device(files, window=window, periodic=periodic, search=search)
    angles = [(float(theta), float(phi)) for theta, phi in incidences]
    device, numbers, parts = set_up(instrument, settings or {}, CHANNELS)
    if device is not None:
        device.reaches(angles)
    name = Path(files[-1]).stem
    records, known = checked_instrument(
        device,
        lambda: _native.simulate_device(
            part,
            unit=unit,
            share=share,
            joined=joined,
            met=met,
            incidences=angles,
            components=list(components),
            seed=seed,
            sample_name=name,
            started=STARTED,
            settings=numbers,
            parts=parts,
            beam_scans=beam_scans,
            watch=lambda done, total: progress("measuring", done, total),
        ),
    )
    stated = tuple(_stated(*k, share=share) for k in known)
    notes = {
        "geometry": [str(Path(f).name) for f in files],
        "window": list(part.window),
        "periodic": periodic,
        "unit": unit,
        "seed": seed,
        "incidences": angles,
        "components": list(components),
        "instrument": numbers,
        "monte_carlo": [vars(k) for k in stated],
    }
    directory = Path(out)
    groups = write_campaign(directory, records, notes | described(device, parts), force=force)
    return GeometryCampaign(
        name=name,
        seed=seed,
        out=directory,
        sample=tuple(directory / g for g in groups if g.startswith("sample")),
        beam=(directory / "beam.txt",),
        dark=(directory / "dark.txt",),
        readings=sum(len(r) for r in records if r.kind == "sample"),
        monte_carlo=stated,
        instrument=device,
        path=paths_of(records),
        warnings=warnings,
    )


def _stated(joined: int, met: int, error_over_noise: Sequence[float], *, share: float) -> MonteCarlo:
    error = np.asarray(error_over_noise, dtype=np.float64)
    return MonteCarlo(
        joined=joined,
        met=met,
        median=float(np.median(error)) if error.size else 0.0,
        worst=float(error.max(initial=0.0)),
        above=float(np.mean(error > share)) if error.size else 0.0,
    )
