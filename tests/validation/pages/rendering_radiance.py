"""Scenes rendered by gonio and by RADIANCE."""

from __future__ import annotations

import resource
from concurrent.futures import ThreadPoolExecutor

from ..radiance import Radiance
from ..radiance_materials import RELEASE
from ..rendering_radiance import ALLOWED, EXACT, Found, compare, upright
from ..scenes import CASES
from . import Skipped, table

EFFORT = 2

TEXT = """# Scenes against RADIANCE

Made by `python -m tests.validation rendering-radiance`, from RADIANCE {release} in pyradiance; a shorter run of the same scenes is
a test (`tests/validation/test_rendering_radiance.py`). {n} small scenes (`tests/validation/scenes`), a material family or a type
of light each: the illuminance of three sensors (`gonio render --sensors`, `rtrace -I`) and the mean luminance of a picture.

They agree when the difference is at most {allowed:.0%} and both standard errors. Of {total} comparisons {good} do; an
asterisk marks what RADIANCE's own approximations move, explained below the table. Half of all differences are below {median:.2%}. gonio took {ours:.0f} s of processor time, rtrace {theirs:.0f} s.

rtrace follows every point for itself, without interpolation, thresholds or limits on weight:
`{options}`. Its standard errors are those of repeated runs of a sensor and of several rays through a pixel, gonio's those it
reports itself.

{rows}
{notes}"""

NOTES = """## What RADIANCE does otherwise

- **`-u-`**, its correlated random numbers, moves means: a wall before a grey floor under an overcast sky by 0.7 %, the
  floor by 1 % with `-ad 9` (standard error 0.05 %). With `-u+` both agree with gonio within 0.1 %.
- **Lights seen by chance**: light of a `light` that reaches a diffuse surface by way of a smooth one (glass, plastic, a
  dielectric) is left out by RADIANCE, unless the surface is a `mirror`. gonio finds it by chance, of a small lamp rarely: on
  the floor before a pane in the sun rtrace reads 20 035 lx, gonio 20 030 ± 5 lx with 65 thousand paths and
  23 100 ± 1 800 lx with a million. The scenes have smooth surfaces only where no such light falls on what is compared.
- **Rough lobes** are not the same in RADIANCE's direct and sampled parts ([radiance-materials.md](radiance-materials.md)); with
  `-ss 16` the difference is small at the angles of these scenes.
- **The eye as the incidence** of a `BSDF`: the tables of these scenes are reciprocal.
- **Jitter**: RADIANCE spreads the direction of the eye over a cell of a table. Means over many directions stay.
- **Peaks of an `aBSDF`**: RADIANCE finds the peak from 29 directions about the unbent one, and so does gonio. gonio then
  takes exactly the cells of the peak out of the table, so that all light of the table is there once. RADIANCE lays a disk
  over them that does not cover all of a cell: some of the peak is there twice. A curtain whose table gives back 0.8 of an
  even sky looks {tree:.3f} bright to rtrace at 30° as a tensor tree and {klems:.3f} ({steep:.3f} at 70°) as Klems matrices, to
  gonio {ours:.3f}. It shows where the eye sees the pane: the pictures of `absdf-klems` and `room-absdf`.
- **Thickness of a `BSDF`**: for the diffuse part of its transmission, RADIANCE {release} looks at the surroundings from the near side
  of the geometry instead of the far side, and meets the proxy a second time: with the screen of `bsdf-klems` the floor below
  gets 12 to 20 % less of the sky and 5 % more of the sun. The table of `bsdf-proxy` has no diffuse transmission, and both agree.
- **`spotlight`**: the length of its direction is the distance of a focus behind it, from which its light falls off. A
  surface looks as bright as it is all the same. gonio does both.
"""


def _row(name: str, about: str, found: Found, mark: str) -> list[str]:
    unit = "cd/m²" if found.what == "picture" else "lx"
    return [
        name,
        about,
        found.what,
        f"{found.ours:.4g} ± {found.ours_error / found.ours:.2%}",
        f"{found.theirs:.4g} ± {found.theirs_error / found.theirs:.2%}",
        unit,
        f"{found.difference:+.2%}" + ("" if found.agrees else f" {mark}"),
    ]


def _seconds(who: int) -> float:
    return resource.getrusage(who).ru_utime


def make() -> str:
    """The page."""
    try:
        import pyradiance  # noqa: PLC0415
    except ImportError as e:
        raise Skipped("pyradiance has no wheel for this platform") from e
    radiance = Radiance(pyradiance)
    rows, all_found = [], []
    start = [_seconds(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    with ThreadPoolExecutor(4) as pool:
        compared = list(pool.map(lambda case: compare(radiance, case, effort=EFFORT), CASES))
    for case, each in zip(CASES, compared, strict=True):
        for k, found in enumerate(each):
            known = abs(found.difference) <= found.allowed + case.approximate.get(found.what, 0.0)
            name, about = (case.name, case.about) if k == 0 else ("", "")
            rows.append(_row(name, about, found, "\\*" if known else "**no**"))
            all_found.append(found)
    spent = [
        _seconds(w) - s for w, s in zip((resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN), start, strict=True)
    ]
    named = {case.name: case for case in CASES}
    absdf = [
        upright(radiance, named[name], theta=theta, n=40000)
        for name, theta in (("absdf-tree", 30.0), ("absdf-klems", 30.0), ("absdf-klems", 70.0))
    ]
    differences = sorted(abs(f.difference) for f in all_found)
    head = ["scene", "", "", "gonio", "RADIANCE", "", "difference"]
    return TEXT.format(
        release=RELEASE,
        n=len(CASES),
        allowed=ALLOWED,
        total=len(all_found),
        good=sum(f.agrees for f in all_found),
        median=differences[len(differences) // 2],
        ours=spent[0],
        theirs=spent[1],
        options=" ".join(EXACT),
        rows=table(head, rows),
        notes=NOTES.format(
            release=RELEASE, tree=absdf[0][1], klems=absdf[1][1], steep=absdf[2][1], ours=absdf[1][0]
        ),
    )
