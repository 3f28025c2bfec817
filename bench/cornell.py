"""The Cornell box of 256 x 256 pixels by 64 samples, paths of at most 8 surfaces: gonio against Mitsuba 3.

`cornell-vs-mitsuba-llvm`, `cornell-vs-mitsuba-scalar`: samples a CPU second of whole processes,
start-up, geometry and compilation included, medians of pairs that alternate in one run. Both draw directions
to the lamp and from the surfaces and weigh them by the balance heuristic; `mean_ours` and `mean_peer` are the
means of the pictures, W/(m2 sr). gonio's side is its own program (crates/trace/examples/cornell.rs), built as
users build it, for any x86-64.
"""

from __future__ import annotations

import json
import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
VARIANTS = {"cornell-vs-mitsuba-llvm": ("llvm_ad_rgb", 64), "cornell-vs-mitsuba-scalar": ("scalar_rgb", 64)}
IDS = tuple(VARIANTS)
SIZE = 256
PAIRS = 5

PEER = """
import json, pathlib, sys, tempfile
import mitsuba as mi
import numpy as np

mi.set_variant(sys.argv[1])
folder = pathlib.Path(tempfile.mkdtemp())
scene = {
    "type": "scene",
    "integrator": {"type": "path", "max_depth": 8, "rr_depth": 6},
    "sensor": {
        "type": "perspective",
        "fov": 39,
        "to_world": mi.ScalarTransform4f().look_at([0.5, -1.35, 0.5], [0.5, 0, 0.5], [0, 0, 1]),
        "film": {"type": "hdrfilm", "width": 256, "height": 256, "rfilter": {"type": "box"}},
        "sampler": {"type": "independent"},
    },
}


def quad(corners, reflectance, radiance=None):
    file = folder / f"{len(scene)}.obj"
    lines = ["v {} {} {}".format(*corner) for corner in corners]
    file.write_text("\\n".join([*lines, "f 1 2 3", "f 1 3 4", ""]))
    diffuse = {"type": "diffuse", "reflectance": {"type": "rgb", "value": reflectance}}
    shape = {
        "type": "obj",
        "filename": str(file),
        "face_normals": True,
        "bsdf": {"type": "twosided", "bsdf": diffuse},
    }
    if radiance is not None:
        shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [radiance] * 3}}
    scene[f"shape{len(scene)}"] = shape


def block(size, turn, at):
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))

    def corner(k):
        x, y, z = size[0] * (k & 1), size[1] * (k >> 1 & 1), size[2] * (k >> 2)
        return [c * x - s * y + at[0], s * x + c * y + at[1], z + at[2]]

    for face in ([0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]):
        quad([corner(k) for k in face], white)


white = [0.75] * 3
quad([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], white)
quad([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], white)
quad([[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]], white)
quad([[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]], [0.63, 0.06, 0.05])
quad([[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]], [0.15, 0.48, 0.09])
lamp = [[0.35, 0.35, 0.998], [0.35, 0.65, 0.998], [0.65, 0.65, 0.998], [0.65, 0.35, 0.998]]
quad(lamp, [0, 0, 0], 15)
block([0.3, 0.3, 0.6], 18, [0.15, 0.5, 0.001])
block([0.3, 0.3, 0.3], -17, [0.58, 0.2, 0.001])
picture = np.array(mi.render(mi.load_dict(scene), spp=int(sys.argv[2]), seed=int(sys.argv[3])))
print(json.dumps(picture.reshape(-1, 3).mean(axis=0).tolist()))
"""


def program() -> Path:
    """gonio's program, built for any processor of this kind."""
    command = ["cargo", "build", "--release", "--quiet", "-p", "gonio-trace", "--example", "cornell"]
    subprocess.run(command, cwd=ROOT, check=True)
    return ROOT / "target" / "release" / "examples" / "cornell"


def timed(command: list[str]) -> tuple[float, list[float]]:
    """CPU seconds of a whole process, and the mean of its picture."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=dict(os.environ))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    mean: list[float] = json.loads(done.stdout)
    return spent, mean


def run() -> list[dict[str, Any]]:
    ours = program()
    records = []
    for name, (variant, samples) in VARIANTS.items():
        mine, theirs = [], []
        for seed in range(1, PAIRS + 1):
            mine.append(timed([str(ours), str(SIZE), str(samples), "7", str(seed)]))
            theirs.append(timed([sys.executable, "-c", PEER, variant, str(samples), str(seed)]))
        count = SIZE * SIZE * samples / 1e6
        records.append(
            {
                "id": name,
                "ours": count / statistics.median(t for t, _ in mine),
                "peer": count / statistics.median(t for t, _ in theirs),
                "peer_name": f"Mitsuba 3 {variant}",
                "ratio": statistics.median(b[0] / a[0] for a, b in zip(mine, theirs, strict=True)),
                "unit": "M samples/CPU s",
                "mean_ours": [statistics.fmean(c) for c in zip(*(m for _, m in mine), strict=True)],
                "mean_peer": [statistics.fmean(c) for c in zip(*(m for _, m in theirs), strict=True)],
                "command": f"python -m bench {name}",
            }
        )
    return records
