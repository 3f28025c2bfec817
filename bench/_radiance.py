"""RADIANCE's BSDF library, called in a loop in C: what its programs do for every ray."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

LOOPS = Path(__file__).with_name("_radiance_loops.c")


class Library:
    """The library and the loops.

    Raises
    ------
    ImportError, FileNotFoundError
        No pyradiance; no C compiler.
    """

    def __init__(self) -> None:
        from pyradiance import bsdf  # noqa: PLC0415

        compiler = shutil.which("cc")
        if compiler is None:
            raise FileNotFoundError("no C compiler (cc) on the path")
        # Loaded already: its symbols are those that Python's module calls.
        self.radiance = ctypes.CDLL(bsdf.__file__)
        self.all = bsdf.SAMPLE_ALL
        with tempfile.TemporaryDirectory() as folder:
            built = Path(folder) / "loops.so"
            subprocess.run([compiler, "-O2", "-shared", "-fPIC", str(LOOPS), "-o", str(built)], check=True)
            self.loops = ctypes.CDLL(str(built))
        self.radiance.SDcacheFile.restype = ctypes.c_void_p
        self.radiance.SDcacheFile.argtypes = [ctypes.c_char_p]
        for name in ("eval_loop", "sample_loop"):
            getattr(self.loops, name).restype = ctypes.c_long

    def load(self, path: Path) -> ctypes.c_void_p:
        """The BSDF of an XML file."""
        found = self.radiance.SDcacheFile(str(path.resolve()).encode())
        if not found:
            raise ValueError(f"{path}: RADIANCE cannot read it")
        return ctypes.c_void_p(found)

    def eval(self, bsdf: ctypes.c_void_p, wi: Array, ws: Array) -> Array:
        """f of pairs of unit vectors (n, 3), both leaving the surface.

        The library looks trees up with its two directions exchanged; given `wi` as the outgoing one it reads
        the cell of (wi, ws).
        """
        value = np.empty(len(ws))
        errors = self.loops.eval_loop(
            ctypes.cast(self.radiance.SDevalBSDF, ctypes.c_void_p),
            bsdf,
            *(ctypes.c_void_p(a.ctypes.data) for a in (wi, ws, value)),
            ctypes.c_long(len(ws)),
        )
        if errors:
            raise ValueError(f"RADIANCE reports {errors} errors")
        return value

    def sample(self, bsdf: ctypes.c_void_p, wi: Array, u: Array) -> tuple[Array, Array]:
        """Directions (n, 3) sampled for incident ones and uniform numbers, and their weights."""
        ws, weight = wi.copy(), np.empty(len(wi))
        errors = self.loops.sample_loop(
            ctypes.cast(self.radiance.SDsampBSDF, ctypes.c_void_p),
            bsdf,
            *(ctypes.c_void_p(a.ctypes.data) for a in (ws, u)),
            ctypes.c_int(self.all),
            ctypes.c_void_p(weight.ctypes.data),
            ctypes.c_long(len(wi)),
        )
        if errors:
            raise ValueError(f"RADIANCE reports {errors} errors")
        return ws, weight
