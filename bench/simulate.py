"""One million readings of a material by the whole virtual goniophotometer, CPU seconds.

`simulate-1m` is the simulation, `simulate-1m-files` adds writing the files, `simulate-1m-gloss` is for a
narrow lobe, which needs more rays. The peer is the project's own limit.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from typing import Any

IDS = ["simulate-1m", "simulate-1m-files", "simulate-1m-gloss"]
LIMIT = 10.0

DIFFUSE = {"model": "lambert", "rho": 0.4}
MATERIALS = {
    "simulate-1m": [DIFFUSE, {"model": "ward-gmd", "rho": 0.08, "alpha": 0.15}],
    "simulate-1m-gloss": [DIFFUSE, {"model": "ward-gmd", "rho": 0.4, "alpha": 0.02}],
}

CHILD = """
import json, sys, time
import gonio
from gonio import simulating
from gonio.materials import Material

start = time.process_time()
seconds = {}
write = simulating._native.write_raw
def first_write(*args, **kwargs):
    seconds.setdefault("simulation", time.process_time() - start)
    return write(*args, **kwargs)
class Watched:
    def __getattr__(self, name):
        return first_write if name == "write_raw" else getattr(gonio._native, name)
simulating._native = Watched()
model = gonio._native.analytic(json.loads(sys.argv[2]))
campaign = gonio.simulate(
    material=Material("bench", "", model, ("reflection",)),
    instrument="pgII-like", incidences=[(40.0, 0.0)], out=sys.argv[1] + "/raw",
    settings={"pitch_across": 0.15, "pitch_along": 0.13},
)
seconds["files"] = time.process_time() - start
print(json.dumps(seconds | {"readings": campaign.readings}))
"""


def measured(name: str) -> dict[str, float]:
    """CPU seconds of a million readings of the material of that name: medians of three runs."""
    done = []
    for _ in range(3):
        with tempfile.TemporaryDirectory() as folder:
            text = subprocess.run(
                [sys.executable, "-c", CHILD, folder, json.dumps(MATERIALS[name])],
                check=True,
                capture_output=True,
                text=True,
            ).stdout
        done.append(json.loads(text))
    if done[0]["readings"] < 1_000_000:
        raise AssertionError(f"{done[0]['readings']} readings")
    return {k: sorted(d[k] * 1e6 / d["readings"] for d in done)[1] for k in ("simulation", "files")}


def run() -> list[dict[str, Any]]:
    """A plastic (diffuse .40, lobe of alpha .15), its raw files on top, and a glossy paint (alpha .02)."""
    plastic, gloss = measured("simulate-1m"), measured("simulate-1m-gloss")
    seconds = (plastic["simulation"], plastic["files"], gloss["simulation"])
    return [
        {
            "id": name,
            "ours": ours,
            "peer": LIMIT,
            "ratio": LIMIT / ours,
            "unit": "CPU s",
            "peer_name": "the project's own limit",
            "command": f"python -m bench {name}",
        }
        for name, ours in zip(IDS, seconds, strict=True)
    ]
