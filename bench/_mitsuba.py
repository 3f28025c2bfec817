"""What the comparisons with Mitsuba 3 share: its set-up, directions, and CPU seconds of alternating pairs."""

from __future__ import annotations

import os
import statistics
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt

from bench._timing import cpu_seconds

COUNT = 10_000_000
"""Directions of one call."""
SCALAR_COUNT = 100_000
"""Directions of one call of the scalar variant, which takes them one by one."""
LLVM = (
    "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1",
    "/usr/lib/llvm-19/lib/libLLVM.so.19.1",
    "/usr/lib/x86_64-linux-gnu/libLLVM.so.20.1",
)
"""Where Debian and Ubuntu put an LLVM that Mitsuba works with: 15 and 16 abort the interpreter."""

Array = npt.NDArray[np.float32]


def mitsuba(variant: str) -> ModuleType | None:
    """Mitsuba 3 with `variant`, on one thread; None with a message when it or its LLVM is missing."""
    found = os.environ.get("DRJIT_LIBLLVM_PATH") or next((p for p in LLVM if Path(p).exists()), None)
    if found is None:
        print("skipped: Mitsuba needs LLVM from 19 on (set DRJIT_LIBLLVM_PATH)", file=sys.stderr)
        return None
    os.environ["DRJIT_LIBLLVM_PATH"] = found
    try:
        import drjit  # noqa: PLC0415
        import mitsuba as mi  # noqa: PLC0415
    except ImportError as error:
        print(f"skipped: {error}", file=sys.stderr)
        return None
    mi.set_variant(variant)
    drjit.set_thread_count(1)
    return mi


def hemisphere(n: int, seed: int = 20261122) -> Array:
    """`n` directions of the front, uniform in solid angle, as columns."""
    rng = np.random.default_rng(seed)
    z, phi = rng.random(n), 2 * np.pi * rng.random(n)
    sine = np.sqrt(1 - z * z)
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), z]).astype(np.float32)


def record(
    name: str,
    peer_name: str,
    ours: Callable[[], Any],
    peer: Callable[[], Any],
    pairs: int = 9,
) -> dict[str, Any]:
    """The record of pairs that alternate, after one call of each to warm up (Mitsuba compiles then)."""
    ours()
    peer()
    times = [(cpu_seconds(ours), cpu_seconds(peer)) for _ in range(pairs)]
    return {
        "id": name,
        "ours": statistics.median(a for a, _ in times),
        "peer": statistics.median(b for _, b in times),
        "peer_name": peer_name,
        "ratio": statistics.median(b / a for a, b in times),
        "unit": "CPU s",
        "command": f"python -m bench {name}",
        "directions": COUNT,
    }


def with_scalar(found: dict[str, Any], seconds: float) -> dict[str, Any]:
    """`found` with the CPU seconds of the scalar variant for as many directions."""
    return found | {"scalar_rgb": seconds, "ratio_scalar_rgb": seconds / found["ours"]}
