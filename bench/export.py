"""A measurement into Radiance XML: gonio against pabopto2bsdf with bsdf2klems and bsdf2ttree.

Both sides start from the same Mountain files and end with an XML file. The ratio compares model to XML with
.sir to XML, CPU seconds (user and system); the seconds of both for files to model are in the record too. The
peer runs once (its Klems export takes the better part of a minute), gonio five times (median).
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path
from typing import Any

import gonio
import numpy as np
from gonio import _native

from bench._timing import cpu, seconds

IDS = ("klems-export-vs-radiance", "ttree-export-vs-radiance")
THETAS = (10, 20, 35, 50, 65, 75)
ALPHA = 0.1
MATERIAL = [
    {"model": "lambert", "rho": 0.4},
    {"model": "ward-gmd-anisotropic", "rho": 0.2, "alpha_x": ALPHA, "alpha_y": ALPHA, "phi_x": 0.0},
]
FRONT = [("front", "reflection")]


def directions(theta_i: float, base: int = 20_000, peak: int = 10_000) -> tuple[np.ndarray, np.ndarray]:
    """Angles in degrees of a Fibonacci spiral to 88.5 degrees and a finer one about the mirror direction."""
    lowest = np.cos(np.radians(88.5))
    golden = 2 * np.pi * 0.6180339887498949

    def spiral(n: int, least: float) -> np.ndarray:
        k = np.arange(n)
        z = 1 - (1 - least) * (k + 0.5) / n
        r = np.sqrt(1 - z * z)
        return np.stack([r * np.cos(golden * k), r * np.sin(golden * k), z], -1)

    t = np.radians(theta_i)
    cone = spiral(peak, np.cos(min(5 * ALPHA, np.radians(25))))
    mirror = np.array([-np.sin(t), 0, np.cos(t)])
    across = np.array([0.0, 1.0, 0.0])
    cone = cone @ np.stack([np.cross(across, mirror), across, mirror])
    both = np.concatenate([spiral(base, lowest), cone[cone[:, 2] > lowest]])
    return np.degrees(np.arccos(both[:, 2])), np.degrees(np.arctan2(both[:, 1], both[:, 0])) % 360


def write_files(folder: Path) -> list[Path]:
    truth = _native.analytic(MATERIAL)
    paths = []
    for theta_i in THETAS:
        theta, phi = directions(theta_i)
        f = truth.eval(theta_i=theta_i, phi_i=0.0, theta_s=theta, phi_s=phi)
        path = folder / f"iso_{theta_i}.txt"
        with path.open("w") as file:
            file.write(
                f'#sample_name "iso"\n#format: theta phi BSDF\n#incident_angle {theta_i} 0\n#upphi 90\n'
                "#colorimetry: CIE-Y\n"
            )
            np.savetxt(file, np.stack([theta, phi, f], -1), fmt="%.4f %.4f %.6g")
        paths.append(path)
    return paths


def peer_seconds(folder: Path, out: str, *command: str) -> float:
    import pyradiance  # noqa: PLC0415

    root = Path(pyradiance.__file__).parent
    environment = {
        **os.environ,
        "PATH": f"{root / 'bin'}:{os.environ['PATH']}",
        "RAYPATH": f".:{root / 'lib'}",
    }
    before = cpu(resource.RUSAGE_CHILDREN)
    with (folder / out).open("wb") as file:
        subprocess.run(
            command, cwd=folder, env=environment, stdout=file, stderr=subprocess.DEVNULL, check=True
        )
    return cpu(resource.RUSAGE_CHILDREN) - before


def error(model: Any) -> float:
    """Mean relative L1 difference from the truth over the measured incidences and those between."""
    truth = _native.analytic(MATERIAL)
    losses = [
        _native.reduction_loss(truth, model, theta_i=t, phi_i=37.0, grid=200)["rel_l1"]
        for t in (10, 15, 20, 27.5, 35, 42.5, 50, 57.5, 65, 70, 75)
    ]
    return float(np.mean(losses))


def run() -> list[dict[str, Any]]:
    records = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        files = write_files(folder)
        peer_model = peer_seconds(folder, "iso.sir", "pabopto2bsdf", *(f.name for f in files))
        our_model, model = seconds(lambda: gonio.build(gonio.process(files)))

        def klems() -> Any:
            reduced = _native.to_klems(model, components=FRONT)
            _native.write_radiance_xml(folder / "ours.xml", reduced, name="iso")
            return reduced

        def tree() -> Any:
            reduced = _native.to_tensor_tree(model, components=FRONT)
            _native.write_radiance_xml(folder / "ours.xml", reduced, name="iso")
            return reduced

        for identity, ours, peer in (
            (IDS[0], klems, ["bsdf2klems", "iso.sir"]),
            (IDS[1], tree, ["bsdf2ttree", "-g", "6", "iso.sir"]),
        ):
            theirs = peer_seconds(folder, "theirs.xml", *peer)
            runs = [seconds(ours) for _ in range(5)]
            mine = statistics.median(t for t, _ in runs)
            records.append(
                {
                    "id": identity,
                    "ours": mine,
                    "peer": theirs,
                    "peer_name": f"RADIANCE {' '.join(peer[:-1])}",
                    "ratio": theirs / mine,
                    "unit": "CPU s",
                    "command": f"python -m bench {identity}",
                    "ours_files_to_model": our_model,
                    "peer_files_to_model": peer_model,
                    "ratio_files_to_xml": (theirs + peer_model) / (mine + our_model),
                    "ours_rel_l1": error(runs[0][1]),
                    "peer_rel_l1": error(_native.read_radiance_xml(folder / "theirs.xml")),
                    "ours_bytes": (folder / "ours.xml").stat().st_size,
                    "peer_bytes": (folder / "theirs.xml").stat().st_size,
                }
            )
    return records
