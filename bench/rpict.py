"""A room with a window under a Perez sky: the CPU seconds that gonio and rpict need for the same error.

`room-vs-rpict`, `glossy-vs-rpict` (table and cupboard of rough plastic and metal), `blind-vs-rpict` (a
diffusing shade of a Klems matrix in the window). The scene is that of examples/scenes, 256 x 256 pixels.

The settings of rpict are those that RADIANCE's own driver `rad` takes for QUALITY=High with medium DETAIL and
VARIABILITY: three times as many pixels a side, filtered by pfilt. The error of a picture is the root of the
mean square of the relative deviation of luminance over all pixels but the hundredth that deviates most
(edges of the window, where filters differ), from a long run of gonio with other seeds; the mean of that run
and rpict's stand in the record. gonio takes as many paths a pixel, in steps of a batch, as bring its error to
that of rpict or to 1 %; the time is that of the whole command.
"""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from bench._timing import cpu

Array = npt.NDArray[np.float64]

SCENES = Path(__file__).parent.parent / "examples" / "scenes"
IDS = ("room-vs-rpict", "glossy-vs-rpict", "blind-vs-rpict")
SIZE = 256
STEP = 8
MOST = 256
FLOOR = 0.01
REFERENCE = 128
"""Paths a pixel of the reference."""

GLOSSY = """\
void plastic wood
0
0
5 .4 .25 .12 .05 .1
void metal white
0
0
5 .7 .68 .64 .9 .15
!genbox wood top 1.6 .8 .04 | xform -t 1.2 3.2 .72
!genbox wood leg .05 .05 .72 | xform -t 1.22 3.22 0 -a 2 -t 1.51 0 0 -i 1
!genbox white cupboard .6 1.6 1.8 | xform -t .02 1 0
"""
SHADE = "void trans shade 0 0 7 .8 .8 .8 0 .25 .6 0\n"
BLIND = """\
void BSDF blind
6 0 shade.xml 0 0 1 .
0
0
blind polygon window
0
0
12 .8 6 .9  3.2 6 .9  3.2 6 2.4  .8 6 2.4
"""
RAD = """\
ZONE= I 0 4 0 6 0 3
EXPOSURE= 1
QUALITY= High
DETAIL= Medium
VARIABILITY= Medium
INDIRECT= 4
PENUMBRAS= True
UP= Z
RESOLUTION= 256
OCTREE= room.oct
scene= {files}
view= r -vf {view}
"""


def environment() -> dict[str, str]:
    """RADIANCE's programs and library, and Python that may keep what it compiled, as installed ones do."""
    import pyradiance  # noqa: PLC0415

    home = Path(pyradiance.__file__).parent
    out = os.environ | {
        "PATH": f"{home / 'bin'}:{os.environ['PATH']}",
        "RAYPATH": f".:{home / 'lib'}",
    }
    out.pop("PYTHONDONTWRITEBYTECODE", None)
    return out


def timed(command: list[str], folder: str) -> tuple[float, bytes]:
    """CPU seconds of a command and all it starts, and what it prints."""
    before = cpu(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, cwd=folder, capture_output=True, check=True, env=environment())
    return cpu(resource.RUSAGE_CHILDREN) - before, done.stdout


def files_of(name: str, folder: str) -> list[str]:
    """The files of a scene; those that are made lie in the folder."""
    files = [str(SCENES / f) for f in ("sky.rad", "room.rad", "furniture.rad", "pane.rad")]
    if name == "glossy-vs-rpict":
        glossy = Path(folder) / "glossy.rad"
        glossy.write_text(GLOSSY)
        files[2] = str(glossy)
    if name == "blind-vs-rpict":
        import gonio  # noqa: PLC0415

        shade, blind = Path(folder) / "shade.rad", Path(folder) / "blind.rad"
        shade.write_text(SHADE)
        made = Path(folder) / "shade.xml"
        gonio.export(shade, to="radiance-klems", channel="green", out=made, as_visible=True)
        blind.write_text(BLIND)
        files[3] = str(blind)
    return files


def luminance(rgb: Array) -> Array:
    out: Array = rgb @ np.array([47.448246, 119.950585, 11.601169])
    return out


def by_rpict(files: list[str], folder: str) -> tuple[float, Array]:
    """CPU seconds of `rad` and luminance."""
    rif = Path(folder) / "room.rif"
    rif.write_text(RAD.format(files=" ".join(files), view=SCENES / "room.vf"))
    spent, _ = timed(["rad", "-s", rif.name], folder)
    _, values = timed(["pvalue", "-h", "-H", "-df", "-o", "room_r.hdr"], folder)
    rgb = np.frombuffer(values, np.float32).astype(np.float64).reshape(-1, 3)
    return spent, luminance(rgb)


def by_gonio(files: list[str], folder: str, samples: int, seed: int) -> tuple[float, Array]:
    """CPU seconds of the command and luminance."""
    out = Path(folder) / "room.hdr"
    options = ["--view", str(SCENES / "room.vf"), "-o", str(out), "--size", str(SIZE)]
    command = [str(Path(sys.executable).with_name("gonio")), "render", *files, *options]
    spent, _ = timed([*command, "--samples", str(samples), "--seed", str(seed)], folder)
    _, values = timed(["pvalue", "-h", "-H", "-df", "-o", out.name], folder)
    rgb = np.frombuffer(values, np.float32).astype(np.float64).reshape(-1, 3)
    return spent, luminance(rgb)


def error(found: Array, reference: Array) -> float:
    """Of all pixels but the hundredth that deviates most."""
    off = np.sort(np.abs(found / reference - 1.0))
    return float(np.sqrt(np.mean(off[: round(0.99 * len(off))] ** 2)))


def record(name: str) -> dict[str, Any]:
    with tempfile.TemporaryDirectory() as folder:
        files = files_of(name, folder)
        # Two halves: their difference is the error of their mean.
        halves = [by_gonio(files, folder, REFERENCE // 2, seed)[1] for seed in (1001, 1002)]
        reference = (halves[0] + halves[1]) / 2.0
        peer, theirs = by_rpict(files, folder)
        wanted = max(error(theirs, reference), FLOOR)
        for samples in range(STEP, MOST + 1, STEP):
            ours, mine = by_gonio(files, folder, samples, 1)
            reached = error(mine, reference)
            if reached <= wanted:
                break
    return {
        "id": name,
        "ours": ours,
        "peer": peer,
        "peer_name": "rpict",
        "ratio": peer / ours,
        "unit": "CPU s",
        "samples": samples,
        "error_ours": reached,
        "error_peer": error(theirs, reference),
        "error_reference": error(halves[0], halves[1]) / 2.0,
        "mean_ours": float(reference.mean()),
        "mean_peer": float(theirs.mean()),
        "command": f"python -m bench {name}",
    }


def run() -> list[dict[str, Any]]:
    wanted = [name for name in IDS if name in sys.argv] or list(IDS)
    return [record(name) for name in wanted]
