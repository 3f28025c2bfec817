"""Two threads against one: `threads-picture`, `threads-sensor`, seconds of the wall clock of the same work.

A picture of the room of examples/scenes, and a single sensor on its table, medians of alternating pairs. On a
machine that does other work as well they mean nothing.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

SCENES = Path(__file__).parent.parent / "examples" / "scenes"
IDS = ("threads-picture", "threads-sensor")
PAIRS = 9


def run() -> list[dict[str, Any]]:
    import gonio  # noqa: PLC0415

    files = [SCENES / name for name in ("sky.rad", "room.rad", "furniture.rad", "pane.rad")]
    scene, _ = gonio.read_scene(*files)

    def picture(threads: int) -> None:
        gonio.render(scene, view=SCENES / "room.vf", size=256, samples=32, threads=threads)

    def sensor(threads: int) -> None:
        point = [[2.0, 3.6, 0.8, 0.0, 0.0, 1.0]]
        gonio.render_sensors(scene, point, samples=1 << 20, relative_error=None, threads=threads)

    def seconds(work: Callable[[int], None], threads: int) -> float:
        start = time.perf_counter()
        work(threads)
        return time.perf_counter() - start

    records = []
    for name, work in zip(IDS, (picture, sensor), strict=True):
        pairs = []
        for k in range(PAIRS):
            # Either goes first in turn, so that a clock that drifts favours neither.
            timed = {threads: seconds(work, threads) for threads in ((2, 1) if k % 2 == 0 else (1, 2))}
            pairs.append((timed[2], timed[1]))
        records.append(
            {
                "id": name,
                "ours": statistics.median(a for a, _ in pairs),
                "peer": statistics.median(b for _, b in pairs),
                "peer_name": "one thread",
                "ratio": statistics.median(b / a for a, b in pairs),
                "unit": "s",
                "command": f"python -m bench {name}",
            }
        )
    return records
