"""Hemispherical integrals of known lobes: the page is the output of a Rust example."""

from __future__ import annotations

import shutil
import subprocess

from ..places import ROOT
from . import Skipped


def make() -> str:
    """The output of crates/geom/examples/quadrature_table."""
    if shutil.which("cargo") is None:
        raise Skipped("cargo is not on this machine")
    command = ["cargo", "run", "--release", "--quiet", "-p", "gonio-geom", "--example", "quadrature_table"]
    return subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE, text=True).stdout
