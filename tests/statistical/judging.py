"""Runs the judge in a process of its own, where there is an LLVM for it."""

from __future__ import annotations

import glob
import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
LEAST_LLVM = 19


class Missing(Exception):
    """What the judge needs and this machine lacks."""


def llvm() -> str:
    """Path of a libLLVM that Mitsuba's vectorised variants run with."""
    if given := os.environ.get("DRJIT_LIBLLVM_PATH"):
        return given
    folders = ("/usr/lib/x86_64-linux-gnu", "/usr/lib64", "/usr/lib", "/usr/lib/llvm-*/lib")
    found = {p for folder in folders for p in glob.glob(f"{folder}/libLLVM*.so*")}
    versions = {p: int(m[1]) for p in sorted(found) if (m := re.search(r"libLLVM(?:\.so\.|-)(\d+)", p))}
    best = max(versions, key=lambda p: versions[p], default=None)
    if best is None or versions[best] < LEAST_LLVM:
        raise Missing(f"no libLLVM of {LEAST_LLVM} or later; DRJIT_LIBLLVM_PATH may name one")
    return best


def judge(samples: int) -> list[dict[str, Any]]:
    """Mitsuba's probabilities of the cases; `Missing` where it cannot run."""
    if importlib.util.find_spec("mitsuba") is None:
        raise Missing("mitsuba has no wheel for this platform")
    run = subprocess.run(
        [sys.executable, "-m", "tests.statistical.judge", str(samples)],
        cwd=ROOT,
        env={**os.environ, "DRJIT_LIBLLVM_PATH": llvm()},
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode != 0:
        raise RuntimeError(f"the judge ended with {run.returncode}:\n{run.stderr[-2000:]}")
    rows: list[dict[str, Any]] = json.loads(run.stdout.splitlines()[-1])
    return rows
