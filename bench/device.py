"""The BSDF of geometry as Klems matrices of 145 by 145 patches: gonio against pyradiance's generate_bsdf.

`slats-vs-genbsdf` (forty tilted slats, diffuse), `prism-vs-genbsdf` (forty prisms of 45 degrees, index 1.5):
CPU seconds of whole processes, light from one side, reflection and transmission. RADIANCE takes 100 samples
a patch for the slats, 4000 for the prisms, where less is done before both have started. Its noise is the root
mean square of its difference from a reference over that of the reference, for reflection and transmission;
gonio takes as many rays as bring both below those (medians of runs). `beyond` is the share of pairs of
patches where the reference and RADIANCE's mean of five runs differ by more than three times both standard
errors (.27 % of normal ones). RADIANCE draws the same numbers in every run, and runs of nearly as many
samples share them (correlated by .85 to 1); those of numbers this far apart do not (about .1).
"""

from __future__ import annotations

import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

IDS = ("slats-vs-genbsdf", "prism-vs-genbsdf")
RUNS = 5
SAMPLES = {"slats": 100, "prism": 4000}
"""Of RADIANCE, a patch."""
FACTORS = (0.5, 0.71, 1.0, 1.3, 1.8)
"""Of these samples, in runs whose numbers are not the same."""
KEYS = (("front", "reflection"), ("front", "transmission"))
RAYS = tuple(16 * k << n for n in range(4, 12) for k in range(4, 8))

OURS = """
import sys
import numpy as np
import gonio

rays, seed = int(sys.argv[2]), int(sys.argv[3])
found = gonio.simulate_geometry(sys.argv[1], rays=rays, seed=seed, sides=sys.argv[4].split(","))
means = [found.means["front", component] for component in ("reflection", "transmission")]
np.save(sys.argv[5], [[m.luminance for m in means], [m.errors for m in means]])
"""

PEER = """
import sys
import numpy as np
import pyradiance

with open(sys.argv[1], "rb") as file:
    found = pyradiance.generate_bsdf(file.read(), nsamp=int(sys.argv[3]), front=False).back
both = found.reflectance, found.transmittance
np.save(sys.argv[2], [np.array(data.split(), float).reshape(145, 145) for data in both])
"""


def polygon(material: str, name: str, corners: list[tuple[float, float, float]]) -> str:
    numbers = " ".join(f"{x:.9g}" for corner in corners for x in corner)
    return f"{material} polygon {name}\n0\n0\n{3 * len(corners)} {numbers}\n"


def slats() -> str:
    """Forty slats of reflectance .5, .012 wide, .02 apart, tilted by 45 degrees, below the plane z = 0."""
    text = "void plastic slat\n0\n0\n5 .5 .5 .5 0 0\n"
    half = 0.012 * math.sqrt(0.5)
    for k in range(40):
        y = 0.02 * k
        text += polygon(
            "slat",
            f"slat{k}",
            [(0, y - half, -2 * half), (1, y - half, -2 * half), (1, y + half, 0), (0, y + half, 0)],
        )
    return text


def prisms() -> str:
    """Forty prisms of 45 degrees side by side, .02 wide, on a film whose flat face lies in z = 0; closed."""
    text = "void dielectric glass\n0\n0\n5 1 1 1 1.5 0\n"
    width, base, count = 0.02, -0.01, 40
    length = count * width
    foot, tip = base, base - 0.5 * width
    text += polygon("glass", "face", [(0, 0, 0), (1, 0, 0), (1, length, 0), (0, length, 0)])
    profile = [(0.0, foot)]
    for k in range(count):
        y = width * k
        profile += [(y + 0.5 * width, tip), (y + width, foot)]
        text += polygon(
            "glass",
            f"left{k}",
            [(0, y, foot), (0, y + width / 2, tip), (1, y + width / 2, tip), (1, y, foot)],
        )
        text += polygon(
            "glass",
            f"right{k}",
            [(0, y + width / 2, tip), (0, y + width, foot), (1, y + width, foot), (1, y + width / 2, tip)],
        )
    text += polygon("glass", "low", [(0, 0, 0), (0, 0, foot), (1, 0, foot), (1, 0, 0)])
    text += polygon("glass", "high", [(0, length, 0), (1, length, 0), (1, length, foot), (0, length, foot)])
    end = [(y, z) for y, z in profile] + [(length, 0.0), (0.0, 0.0)]
    text += polygon("glass", "near", [(0, y, z) for y, z in reversed(end)])
    text += polygon("glass", "far", [(1, y, z) for y, z in end])
    return text


def timed(code: str, *arguments: object) -> float:
    """CPU seconds of a whole process and its children."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        check=True,
        capture_output=True,
        env=dict(os.environ),
    )
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def noise(found: Array, reference: Array) -> Array:
    """Relative root mean square difference, of each table."""
    difference = ((found - reference) ** 2).mean(axis=(1, 2))
    return np.asarray(np.sqrt(difference / (reference**2).mean(axis=(1, 2))))


def compare(name: str, text: str, folder: Path) -> dict[str, Any]:
    from gonio import _native  # noqa: PLC0415

    scene, out = folder / f"{name}.rad", folder / f"{name}.npy"
    scene.write_text(text)
    angles = np.asarray(_native.klems_solid_angles("LBNL/Klems Full"))
    timed(OURS, scene, 2**16, 99, "front,back", out)
    reference, error = np.load(out)
    theirs, tables = [], []
    for factor in FACTORS:
        timed(PEER, scene, out, round(SAMPLES[name] * factor))
        # RADIANCE gives flux of the exit patch for radiance of the incident one.
        tables.append(np.load(out) / angles[:, None])
    for _ in range(3):
        theirs.append(timed(PEER, scene, out, SAMPLES[name]))
    as_one = [noise(t, reference) * math.sqrt(f) for t, f in zip(tables, FACTORS, strict=True)]
    peer_noise = np.median(as_one, axis=0)
    for rays in RAYS:
        ours = []
        for seed in (1, 2, 3):
            timed(OURS, scene, rays, seed, "front", out)
            ours.append(noise(np.load(out)[0], reference))
        our_noise = np.median(ours, axis=0)
        if (our_noise <= peer_noise).all():
            break
    times = [timed(OURS, scene, rays, seed, "front", out) for seed in range(1, RUNS + 1)]
    weight = np.array(FACTORS)[:, None, None, None]
    mean = np.average(tables, axis=0, weights=FACTORS)
    # Few runs: the scatter of a pair is at least that of all pairs of a table, in proportion to their values.
    spread = (weight * (np.array(tables) - mean) ** 2).sum(axis=0)
    scatter = spread / (len(FACTORS) - 1) / sum(FACTORS)
    usual = (scatter.sum(axis=(1, 2)) / mean.sum(axis=(1, 2)))[:, None, None] * mean
    beyond = float((np.abs(mean - reference) > 3 * np.sqrt(np.maximum(scatter, usual) + error**2)).mean())
    return {
        "id": f"{name}-vs-genbsdf",
        "ours": statistics.median(times),
        "peer": statistics.median(theirs),
        "peer_name": "RADIANCE, generate_bsdf of pyradiance",
        "ratio": statistics.median(theirs) / statistics.median(times),
        "unit": "CPU s",
        "rays": rays,
        "noise_ours": our_noise.tolist(),
        "noise_peer": peer_noise.tolist(),
        "beyond": beyond,
        "albedo_ours": (reference * angles[:, None]).sum(axis=1)[:, 0].tolist(),
        "albedo_peer": (mean * angles[:, None]).sum(axis=1)[:, 0].tolist(),
        "command": f"python -m bench {name}-vs-genbsdf",
    }


def run() -> list[dict[str, Any]]:
    with tempfile.TemporaryDirectory() as folder:
        records = [compare("slats", slats(), Path(folder)), compare("prism", prisms(), Path(folder))]
    return records
