"""Virtual measurement campaigns: raw files of a material whose scattering is known."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from gonio import _native
from gonio._native import DomainError, Scan
from gonio.files import replacing_directory
from gonio.materials import MATERIALS, Component, Material, material_of_file
from gonio.materials import material as named_material
from gonio.readings import PathLike
from gonio.working import interruptible

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
    "distance",
    "aperture",
    "noise_readout",
    "noise_relative",
    "dark_level",
    "dark_swing",
    "dark_period",
    "saturation",
    "rate",
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
    """Raw files of a campaign in the directory `out`, and how many readings the sample's files hold."""

    material: Material
    seed: int
    out: Path
    sample: tuple[Path, ...]
    beam: tuple[Path, ...]
    dark: tuple[Path, ...]
    readings: int


def simulate(
    *,
    material: PathLike | Material = "plastic",
    seed: int = 1,
    incidences: Sequence[tuple[float, float]] | None = None,
    components: Sequence[Component] | None = None,
    instrument: Mapping[str, float] | None = None,
    out: str | os.PathLike[str],
    force: bool = False,
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
        Numbers that replace those of the default instrument, angles in degrees: power, beam_half_width (1/e,
        Gaussian) or beam_radius (even), spot_diameter, distance (m), aperture (half angle), noise_readout,
        noise_relative, dark_level, dark_swing, dark_period (s), saturation, rate (1/s), shadow (half angle),
        pointing, pitch_across, pitch_along, theta_max, jitter, patch_radius, patch_pitch, patch_growth,
        patch_along.
    out
        Directory of the files; it appears whole or not at all.
    force
        Write into a directory that holds other files.

    Raises
    ------
    DomainError
        A parameter outside its range.
    FormatError
        `out` holds other files and `force` is not set.
    OSError
        The file system refuses.
    """
    if not 0 <= seed < 2**64:
        raise DomainError(f"seed: found {seed}, allowed 0 to 2**64 - 1")
    target = material if isinstance(material, Material) else _named(material)
    angles = [(float(t), float(p)) for t, p in (target.incidences if incidences is None else incidences)]
    hemispheres = list(target.components if components is None else components)
    settings = {name: float(value) for name, value in (instrument or {}).items()}
    records = interruptible(
        lambda: _native.simulate(
            target.bsdf,
            incidences=angles,
            components=hemispheres,
            seed=seed,
            sample_name=target.name,
            started=STARTED,
            settings=settings,
        )
    )
    notes = {
        "material": target.name,
        "description": target.description,
        "seed": seed,
        "incidences": angles,
        "components": hemispheres,
        "instrument": settings,
    }
    groups: dict[str, list[Scan]] = {}
    for record in records:
        groups.setdefault(_file_name(record), []).append(record)
    directory = Path(out)
    with replacing_directory(directory, marker=NOTEBOOK, owned=FILES, force=force) as staged:
        for name, scans in groups.items():
            _native.write_raw(staged / name, scans)
        (staged / NOTEBOOK).write_text(json.dumps(notes, indent=2) + "\n", encoding="utf-8")
    sample = tuple(directory / name for name in groups if name.startswith("sample"))
    return Campaign(
        material=target,
        seed=seed,
        out=directory,
        sample=sample,
        beam=(directory / "beam.txt",),
        dark=(directory / "dark.txt",),
        readings=sum(len(r) for r in records if r.kind == "sample"),
    )


def _named(material: PathLike) -> Material:
    """The material of that name, or of the model in that file."""
    if str(material) not in MATERIALS and Path(material).is_file():
        return material_of_file(material)
    return named_material(str(material))


def _file_name(record: Scan) -> str:
    if record.kind != "sample":
        return f"{record.kind}.txt"
    return f"sample_theta{record.theta_i:05.1f}_phi{record.phi_i:05.1f}.txt"
