"""Writes skies.txt, radiances.txt and functions.txt of crates/scene/tests/data: what RADIANCE gives.

Needs pyradiance 1.3: `python tests/validation/scene_oracle.py`. A line of skies.txt is the command, a bar,
and every word that is printed outside comments; of radiances.txt a command, a direction and the radiance that
rtrace finds there under a glow; of functions.txt the same of a formula.
"""

import itertools
import math
import os
import random
import subprocess
import tempfile
from pathlib import Path

import pyradiance

BIN = Path(pyradiance.__file__).parent / "bin"
PLACES = [
    "",
    "-a 52.52 -o -13.4 -m -15",
    "-a -33.9 -o -151.2 -m -150",
    "-a 68.4 -o -17.4 -m -15",
    "-a 1.3 -o -103.8 -m -120",
]


def printed(words: str) -> str:
    command, *rest = words.split()
    run = subprocess.run([BIN / command, *rest], capture_output=True, text=True, check=True)
    lines = (line for line in run.stdout.splitlines() if not line.startswith("#"))
    return " ".join(" ".join(lines).split())


def commands() -> list[str]:
    dates = ["6 21 12", "3 20 +9.25", "12 21 10.5", "9 1 16", "2 29 17.75", "6 1 5"]
    skies = [
        "",
        "-s",
        "+s -g .3",
        "-c",
        "-u -b 20",
        "-i",
        "+i",
        "-c -B 70",
        "+s -B 100 -R 400",
        "-s -t 4",
        "+i -r 1e6",
        "-u -y 2024",
    ]
    light = [
        "-W 600 150",
        "-W 0 120 -g .1",
        "-L 60000 15000",
        "-G 300 150",
        "-E 450",
        "-P 1.2 .3",
        "-P 1 .2 -s",
        "-P 2 .15 -O 1",
        "-P 3.5 .1 -O 2",
        "-P 5 .2",
        "-W 850 60 -y 2023",
        "-W 200 250 -i 60",
        "-W 600 150 -c",
        "-W 5 2",
        "-W 1400 1",
        "-L 0 8000",
    ]
    every = [f"gensky {d} {s} {p}" for d, s, p in itertools.product(dates, skies, PLACES)]
    every += [f"gendaylit {d} {s} {p}" for d, s, p in itertools.product(dates, light, PLACES)]
    every = random.Random(5).sample(every, 200)
    angles = ["-ang 45 0", "-ang 5 -120", "-ang 89 30", "-ang -3 10"]
    every += [
        f"gensky {d} {s}"
        for d, s in itertools.product([*angles, "7 4 14:30CEST", "7 4 9:15pdt -a 37 -o 122"], skies[:7])
    ]
    every += [f"gendaylit {a} {s}" for a, s in itertools.product(angles[:3], light)]
    return [" ".join(c.split()) for c in every]


def directions(source: random.Random, n: int) -> list[list[float]]:
    """Directions from 17 degrees below the horizon to the zenith, six decimals a component."""
    every = []
    for _ in range(n):
        z, phi = source.uniform(-0.3, 1), source.uniform(0, 2 * math.pi)
        level = math.sqrt(1 - z * z)
        every.append([float(f"{x:.6f}") for x in (level * math.cos(phi), level * math.sin(phi), z)])
    return every


def seen(pattern: str, towards: list[list[float]]) -> list[float]:
    """What rtrace sees of a glow under the pattern `skyfunc`."""
    env = {**os.environ, "RAYPATH": f".:{BIN.parent / 'lib'}", "PATH": f"{BIN}:{os.environ['PATH']}"}
    with tempfile.TemporaryDirectory() as folder:
        octree, scene = Path(folder) / "s.oct", Path(folder) / "s.rad"
        scene.write_text(f"{pattern}\nskyfunc glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 360\n")
        octree.write_bytes(
            subprocess.run([BIN / "oconv", scene], capture_output=True, env=env, check=True).stdout
        )
        rays = "".join(f"0 0 0 {x} {y} {z}\n" for x, y, z in towards)
        run = [BIN / "rtrace", "-h", "-ab", "0", octree]
        out = subprocess.run(run, input=rays, text=True, capture_output=True, env=env, check=True).stdout
    return [float(line.split()[1]) for line in out.splitlines() if line.strip()]


SKIES = [
    "gensky -ang 35 40 -s",
    "gensky -ang 60 -70 -i",
    "gensky -ang 35 0 -c",
    "gensky -ang 20 0 -u",
    "gendaylit -ang 40 20 -W 600 150 -s",
    "gendaylit -ang 15 -60 -W 50 120 -s",
    "gendaylit -ang 55 0 -P 1 .3 -s",
]
FORMULAS = [
    "nrand(Dx)+6",
    "rand(Dx*9)+1",
    "hermite(Dx,Dy,Dz,1,.3)+2",
    "bspline(Dx,Dy,Dz,1,.3)+2",
    "bezier(Dx,Dy,Dz,1,.3)+2",
    "mod(Dx*9,2)+tri(Dy*7,3)+1",
    "erf(Dx)+erfc(Dy)+2",
    "inside(-.2,Dx,.4)+xor(Dy,Dz)+4",
    "atan2(Dy,Dx)+Acos(Dz*1.2)+5",
    "clipgrey(Dx,Dy,Dz)+fade(3,1,Dz*5)",
]


def radiances() -> list[str]:
    source, lines = random.Random(3), []
    for command in SKIES:
        name, *rest = command.split()
        text = subprocess.run([BIN / name, *rest], capture_output=True, text=True, check=True).stdout
        towards = [*directions(source, 10), [0.0, 0.0, 1.0]]
        lines += [
            f"{command} | {x} {y} {z} | {v}"
            for (x, y, z), v in zip(towards, seen(text, towards), strict=True)
        ]
    return lines


def functions() -> list[str]:
    source, lines = random.Random(3), []
    for formula in FORMULAS:
        with tempfile.NamedTemporaryFile("w", suffix=".cal") as file:
            file.write(f"out = {formula};\n")
            file.flush()
            towards = directions(source, 4)
            values = seen(f"void brightfunc skyfunc\n2 out {file.name}\n0\n0", towards)
        lines += [f"{formula} | {x} {y} {z} | {v}" for (x, y, z), v in zip(towards, values, strict=True)]
    return lines


if __name__ == "__main__":
    text = "".join(f"{c} | {printed(c)}\n" for c in commands())
    here = Path(__file__).parents[2] / "crates/scene/tests/data"
    (here / "skies.txt").write_text(text)
    (here / "radiances.txt").write_text("\n".join(radiances()) + "\n")
    (here / "functions.txt").write_text("\n".join(functions()) + "\n")
