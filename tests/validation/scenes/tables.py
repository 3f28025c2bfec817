"""Scenes with measured materials: Klems matrices and tensor trees of `BSDF` and `aBSDF`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import gonio

from .case import STAGE, Case
from .lights import UNDER_SKY
from .materials import BELOW, HANGING, LIGHT, PLATE, SKY, SUN, UNDERSIDE

SCRIM = "void trans m 0 0 7 .8 .8 .8 .05 .3 .6 .6\n"
"""Scatters on both sides, a broad lobe in transmission."""

CURTAIN = "void trans m 0 0 7 .8 .8 .8 0 0 .6 .5\n"
"""Diffuse on both sides, and light that comes straight through."""

SATIN = "void plastic2 m 4 1 0 0 . 0 6 .35 .35 .35 .25 .2 .4\n"
"""Anisotropic reflection."""


def table(material: str, to: str, **options: object) -> Callable[[Path], None]:
    """Writes the BSDF file of a Radiance material."""

    def write(path: Path) -> None:
        source = path.with_suffix(".source.rad")
        source.write_text(material)
        gonio.export(source, to=to, channel="green", out=path, as_visible=True, **options)

    return write


PRISM = "void trans m 0 0 7 .8 .8 .8 .05 .3 .6 1\n"
"""Scatters on both sides, without a diffuse part in transmission."""

KLEMS = {"m.xml": table(SCRIM, "radiance-klems")}
TREE = {"m.xml": table(SATIN, "radiance-ttree", max_depth=5)}
PEAK = {"m.xml": table(CURTAIN, "radiance-ttree")}
PEAK_KLEMS = {"m.xml": table(CURTAIN, "radiance-klems")}

BSDF = "void BSDF m 6 0 m.xml 0 1 0 . 0 "

FIELD = "ux = if(Px, 1, -1); uy = 1; uz = Dx;\n"
"""Up turns at the middle of the plate."""

SLATS = """void plastic slat 0 0 5 .5 .5 .5 0 0
!genbox slat s 2.4 .02 .08 | xform -t -1.2 -.9 .85 -a 10 -t 0 .2 0
"""

TABLES = (
    Case(
        "bsdf-klems",
        "`BSDF`, Klems matrices, under sun and even sky",
        STAGE + SUN + SKY + BSDF + "0\n" + HANGING,
        files=KLEMS,
        sensors=BELOW,
        view=UNDERSIDE,
        pixel_samples=32,
        **UNDER_SKY,
    ),
    Case(
        "bsdf-tree",
        "`BSDF`, anisotropic tensor tree, under a lamp",
        STAGE + LIGHT + "void BSDF m 6 0 m.xml 1 1 .2 . 0 0\n" + PLATE,
        files=TREE,
        pixel_rays=24,
        repeats=64,
    ),
    Case(
        "bsdf-diffuse",
        "`BSDF` with diffuse parts beside the file's and a pattern",
        STAGE
        + SUN
        + SKY
        + "void brightfunc stripes 2 if(sin(9*Px),.9,.4) . 0 0\nstripes BSDF m 6 0 m.xml 0 1 0 . 0 9 "
        + ".1 .05 0  .2 .1 .05  .05 .1 .15\n"
        + HANGING,
        files=KLEMS,
        sensors=BELOW,
        samples=1 << 17,
        **UNDER_SKY,
    ),
    Case(
        "bsdf-up",
        "`BSDF` whose up vector is a function",
        STAGE + LIGHT + "void BSDF m 6 0 m.xml ux uy uz up.cal 0 0\n" + PLATE,
        files=TREE | {"up.cal": FIELD},
        pixel_rays=24,
        repeats=64,
    ),
    Case(
        "absdf-tree",
        "`aBSDF`, tensor tree, under sun and even sky",
        STAGE + SUN + SKY + "void aBSDF m 5 m.xml 0 1 0 . 0 0\n" + HANGING,
        files=PEAK,
        sensors=BELOW,
        view=UNDERSIDE,
        samples=1 << 14,
        pixel_samples=32,
        **UNDER_SKY,
    ),
    Case(
        "absdf-klems",
        "`aBSDF`, Klems matrices, under sun and even sky",
        STAGE + SUN + SKY + "void aBSDF m 5 m.xml 0 1 0 . 0 0\n" + HANGING,
        files=PEAK_KLEMS,
        sensors=BELOW,
        view=UNDERSIDE,
        samples=1 << 14,
        pixel_samples=32,
        approximate={"picture": 0.02},
        **UNDER_SKY,
    ),
    Case(
        "bsdf-proxy",
        "`BSDF` with a thickness, before slats that only the eye and the sun see",
        STAGE
        + SUN
        + SKY
        + "void BSDF m 6 .3 m.xml 0 1 0 . 0 0\n"
        + SLATS
        + "m polygon plate 0 0 12 -1.2 -1 .8  -1.2 1 .8  1.2 1 .8  1.2 -1 .8\n",
        files={"m.xml": table(PRISM, "radiance-klems")},
        sensors=BELOW,
        view=UNDERSIDE,
        **UNDER_SKY,
    ),
)
"""The scenes."""
