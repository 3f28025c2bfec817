"""BSDF XML: gonio's values against those of RADIANCE's own library."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from gonio import _native

from ..places import SHARED
from ..radiance import FILES, MODELS, Radiance, differences
from . import Skipped, table

TEXT = """# Radiance BSDF XML against RADIANCE

Made by `python -m tests.validation radiance-xml`. 4000 pairs of directions, both sides, uniform in projected solid angle
(fixed seed); relative difference of gonio's value from that of RADIANCE's library (pyradiance {version}) for the same
file, over the pairs that scatter. RADIANCE changes what it looks up on purpose, by up to 3·10⁻⁴ for matrices and
2·10⁻⁴ for trees. Both agree which pairs scatter. A direction within rounding of the edge of a patch or cell may fall
on either side of it, so that a rare pair may differ by more.

## Files of others, read

{read}
## Files of gonio, written

{written}"""

HEAD = ["file", "pairs that scatter", "median", "99 %", "99.8 %", "largest"]


def row(name: str, radiance: Radiance, path: Path, model: Any) -> list[str]:
    """Quantiles of the differences."""
    error, values = differences(radiance, path, model)
    quantiles = np.quantile(error, [0.5, 0.99, 0.998, 1.0])
    return [name, str(len(values)), *(f"{q:.1e}" for q in quantiles)]


def make() -> str:
    """The page."""
    try:
        import pyradiance  # noqa: PLC0415
    except ImportError as e:
        raise Skipped("pyradiance has no wheel for this platform") from e
    radiance = Radiance(pyradiance)
    missing = [f for f in FILES if not (SHARED / f).exists()]
    if missing:
        raise Skipped(f"{', '.join(missing)} not there")
    read = [row(f, radiance, SHARED / f, _native.read_radiance_xml(SHARED / f)) for f in FILES]
    written = []
    with tempfile.TemporaryDirectory() as folder:
        for name, lobes in MODELS.items():
            source = _native.analytic(lobes)
            reduced = {f"Klems {b}": _native.to_klems(source, basis=b) for b in ("full", "half", "quarter")}
            for rank in (3, 4):
                if (name, rank) != ("anisotropic", 3):
                    tree = _native.to_tensor_tree(source, rank=rank, max_cells=20_000)
                    reduced[f"tensor tree, rank {rank}"] = tree
            for kind, model in reduced.items():
                path = Path(folder) / f"{name}-{kind.replace(' ', '-')}.xml"
                _native.write_radiance_xml(path, model, name=name)
                written.append(row(f"{name}, {kind}", radiance, path, model))
    return TEXT.format(version=pyradiance.__version__, read=table(HEAD, read), written=table(HEAD, written))
