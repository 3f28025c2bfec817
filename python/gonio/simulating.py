"""Virtual measurement campaigns: raw files of a material whose scattering is known."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from gonio import _native
from gonio._native import DomainError, Scan
from gonio.files import replacing_directory
from gonio.instrument_spectra import outputs
from gonio.instruments import Instrument, read_instrument
from gonio.materials import MATERIALS, Component, Material, material_of_file
from gonio.materials import material as named_material
from gonio.readings import PathLike
from gonio.simulated_path import PathOfScan, paths_of
from gonio.working import Progress, interruptible, silent

T = TypeVar("T")

NOTEBOOK = "campaign.json"
"""Name of the file that keeps what was simulated; the measurement chain does not read it."""

FILES = ("sample_*.txt", "beam.txt", "dark.txt")
"""Names of a campaign's raw files."""

STARTED = "2026-01-05T08:00:00Z"
"""Begin of every virtual campaign: the same settings give the same files."""

INSTRUMENT = (
    "power",
    "beam_half_width",
    "beam_radius",
    "spot_diameter",
    "lamp_drift",
    "lamp_flicker",
    "lamp_flicker_time",
    "sample_diameter",
    "sample_width",
    "sample_height",
    "overfill",
    "tilt_x",
    "tilt_y",
    "offset",
    "holder_radius",
    "distance",
    "aperture",
    "noise_readout",
    "noise_shot",
    "noise_relative",
    "dark_level",
    "dark_swing",
    "dark_period",
    "saturation",
    "bits",
    "rate",
    "speed",
    "integration",
    "shadow",
    "pointing",
    "pitch_across",
    "pitch_along",
    "theta_max",
    "jitter",
    "patch_radius",
    "patch_pitch",
    "patch_growth",
    "patch_along",
)
"""Names of the numbers of the virtual instrument that can be set."""


@dataclass(frozen=True)
class Campaign:
    """Raw files of a campaign in the directory `out`, and how many readings the sample's files hold.

    `instrument` is the one of a file that measured, `path` where it read the sample, one entry an incidence.
    """

    material: Material
    seed: int
    out: Path
    sample: tuple[Path, ...]
    beam: tuple[Path, ...]
    dark: tuple[Path, ...]
    readings: int
    instrument: Instrument | None = None
    path: tuple[PathOfScan, ...] = ()


def simulate(
    *,
    material: PathLike | Material = "plastic",
    seed: int = 1,
    incidences: Sequence[tuple[float, float]] | None = None,
    components: Sequence[Component] | None = None,
    instrument: PathLike | Instrument | Mapping[str, float] | None = None,
    settings: Mapping[str, float] | None = None,
    beam_scans: int = 3,
    out: str | os.PathLike[str],
    force: bool = False,
    progress: Progress = silent,
) -> Campaign:
    """Measure a known material with the virtual goniophotometer and write its raw files.

    The instrument takes dark records with closed shutter, reference scans of the bare beam and, for every
    incidence, a path over the hemispheres that is refined around the mirror and unbent directions. The files
    are gonio raw text (docs/formats/gonio-raw.md): `sample_*.txt` one an incidence, `beam.txt`, `dark.txt`,
    and `campaign.json`, which notes the settings and is not read by the measurement chain.

    Parameters
    ----------
    material
        Name of a material (`gonio.materials.MATERIALS`), a file of a model that `gonio.read_bsdf` reads, or a
        `Material`.
    seed
        Seed of path, noise and drift, 0 to 2**64 - 1; the same seed gives the same files.
    incidences
        (theta_i, phi_i) in degrees, none within a degree of the sample plane; above 90 the back is lit, which
        scatters as the front does. None takes the material's.
    components
        Hemispheres to scan, of "reflection" and "transmission"; None takes what the material scatters into.
    instrument
        File of an instrument (docs/formats/instrument-toml.md), the name of one that comes with gonio
        (`gonio.instruments.presets`), an `Instrument`, or numbers that replace those of the default
        instrument as `settings` does.
    settings
        Numbers that replace those of the instrument: lengths in metres, angles in degrees, levels in the unit
        of the signal, names as in `INSTRUMENT`; docs/virtual-goniophotometer.md lists them.
    beam_scans
        Number of reference scans of the bare beam, 1 to 100.
    out
        Directory of the files; it appears whole or not at all.
    force
        Write into a directory that holds other files.
    progress
        Called with stage, incidences done and incidences in all; an exception of its ends the campaign.

    Raises
    ------
    DomainError
        A parameter outside its range, an incidence out of the holder's reach, a spot that passes the sample
        without `overfill`, a detector whose light the material says nothing of.
    FormatError
        `out` holds other files and `force` is not set; an instrument file that is wrong.
    OSError
        The file system refuses.
    """
    if not 0 <= seed < 2**64:
        raise DomainError(f"seed: found {seed}, allowed 0 to 2**64 - 1")
    target = material if isinstance(material, Material) else _named(material)
    angles = [(float(t), float(p)) for t, p in (target.incidences if incidences is None else incidences)]
    hemispheres = list(target.components if components is None else components)
    device, numbers, parts = set_up(instrument, settings or {}, target.bsdf.channels)
    if device is not None:
        device.reaches(angles)
    records = checked_instrument(
        device,
        lambda: _native.simulate(
            target.bsdf,
            incidences=angles,
            components=hemispheres,
            seed=seed,
            sample_name=target.name,
            started=STARTED,
            settings=numbers,
            parts=parts,
            beam_scans=beam_scans,
            watch=lambda done, total: progress("measuring", done, total),
        ),
    )
    notes = {
        "material": target.name,
        "description": target.description,
        "seed": seed,
        "incidences": angles,
        "components": hemispheres,
        "instrument": numbers,
    }
    notes |= described(device, parts)
    directory = Path(out)
    groups = write_campaign(directory, records, notes, force=force)
    sample = tuple(directory / name for name in groups if name.startswith("sample"))
    return Campaign(
        material=target,
        seed=seed,
        out=directory,
        sample=sample,
        beam=(directory / "beam.txt",),
        dark=(directory / "dark.txt",),
        readings=sum(len(r) for r in records if r.kind == "sample"),
        instrument=device,
        path=paths_of(records),
    )


def described(device: Instrument | None, parts: Mapping[str, Any]) -> dict[str, Any]:
    """What the notes of a campaign say of a described instrument."""
    if device is None:
        return {}
    return {
        "name": device.name,
        "parts": {k: v for k, v in parts.items() if k != "table"},
        "u_calibration": device.u_calibration,
    }


def write_campaign(
    directory: Path, records: Sequence[Scan], notes: Mapping[str, Any], *, force: bool
) -> list[str]:
    """Write the raw files of records and the notes; the names of the files."""
    groups: dict[str, list[Scan]] = {}
    for record in records:
        groups.setdefault(_file_name(record), []).append(record)
    with replacing_directory(directory, marker=NOTEBOOK, owned=FILES, force=force) as staged:
        for name, scans in groups.items():
            _native.write_raw(staged / name, scans)
        (staged / NOTEBOOK).write_text(json.dumps(notes, indent=2) + "\n", encoding="utf-8")
    return list(groups)


def checked_instrument(device: Instrument | None, work: Callable[[], T]) -> T:
    """What `work` gives; an error of a described instrument names its file."""
    try:
        return interruptible(work)
    except DomainError as error:
        if device is None:
            raise
        raise DomainError(f"{device.source}: {error}") from None


def set_up(
    instrument: PathLike | Instrument | Mapping[str, float] | None,
    settings: Mapping[str, float],
    channels: Sequence[str],
) -> tuple[Instrument | None, dict[str, float], dict[str, Any]]:
    """The described instrument if any, its numbers and its parts for a material of these channels."""
    if instrument is None or isinstance(instrument, Mapping):
        numbers = {name: float(value) for name, value in {**(instrument or {}), **settings}.items()}
        return None, numbers, {}
    device = instrument if isinstance(instrument, Instrument) else read_instrument(instrument)
    device = device.with_settings({name: float(value) for name, value in settings.items()})
    parts = dict(device.parts)
    if device.channels and device.lamp is not None:
        parts["outputs"] = outputs(device.channels, lamp=device.lamp, of=channels)
    return device, dict(device.settings), parts


def _named(material: PathLike) -> Material:
    """The material of that name, or of the model in that file."""
    if str(material) not in MATERIALS and Path(material).is_file():
        return material_of_file(material)
    return named_material(str(material))


def _file_name(record: Scan) -> str:
    if record.kind != "sample":
        return f"{record.kind}.txt"
    return f"sample_theta{record.theta_i:05.1f}_phi{record.phi_i:05.1f}.txt"
