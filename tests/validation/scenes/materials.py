"""A scene for each family of materials that have a formula."""

from .case import STAGE, Case
from .lights import LAMP, UNDER_SKY

LIGHT = "void light l 0 0 3 30 28 25\nl " + LAMP

PLATE = "m polygon plate 0 0 12 -.8 .2 .15  .8 .2 .15  .8 .9 .75  -.8 .9 .75\n"
"""Slanted before the wall, its front to the lamp and the eye."""

BACK = ((0.0, -0.4, 0.02, 0.0, 0.0, 1.0), (0.0, 1.4, 0.02, 0.0, 0.0, 1.0), (0.3, 1.9, 0.5, 0.0, -1.0, 0.0))
"""Before the plate, behind it, and on the wall behind."""

SKY = """void glow g 0 0 4 3 3.2 4 0
g source sky 0 0 4 0 0 1 180
"""

SUN = "void light l 0 0 3 2e6 1.9e6 1.8e6\nl source sun 0 0 4 .3 -.5 .8 .533\n"

HANGING = "m polygon plate 0 0 12 -1.2 -1 1  1.2 -1 1  1.2 1 1  -1.2 1 1\n"
"""Level above the floor, its front up."""

BELOW = ((0.0, -0.2, 0.02, 0.0, 0.0, 1.0), (0.5, 0.3, 0.5, 0.3, 0.2, 1.0), (0.0, 0.2, 1.6, 0.0, 0.0, -1.0))
"""Two below it, one above that looks at it."""

UNDER = (*BELOW[:2], (0.3, 1.9, 0.5, 0.0, -1.0, 0.0))
"""Two below it and one on the wall: where no sunlight comes that a smooth surface mirrors."""

UNDERSIDE = "-vtv -vp 0 -1.8 .3 -vd 0 1.8 .55 -vu 0 0 1 -vh 50 -vv 40"

SLAB = """m polygon top 0 0 12 -1 -1 1  1 -1 1  1 1 1  -1 1 1
m polygon bottom 0 0 12 -1 -1 .8  -1 1 .8  1 1 .8  1 -1 .8
m polygon south 0 0 12 -1 -1 .8  1 -1 .8  1 -1 1  -1 -1 1
m polygon north 0 0 12 -1 1 .8  -1 1 1  1 1 1  1 1 .8
m polygon west 0 0 12 -1 -1 .8  -1 -1 1  -1 1 1  -1 1 .8
m polygon east 0 0 12 1 -1 .8  1 1 .8  1 1 1  1 -1 1
"""
"""A body of a fifth of a metre above the floor."""

WATER = "w sphere drop 0 0 4 0 0 .9 1.45\n"
"""Water about the slab."""

MATERIALS = (
    Case(
        "plastic",
        "`plastic`, gloss of α = 0.1",
        STAGE + LIGHT + "void plastic m 0 0 5 .5 .3 .2 .06 .1\n" + PLATE,
    ),
    Case(
        "metal",
        "`metal`, α = 0.15",
        STAGE + LIGHT + "void metal m 0 0 5 .8 .6 .3 .8 .15\n" + PLATE,
        pixel_rays=24,
        repeats=64,
    ),
    Case(
        "trans",
        "`trans`, diffuse and smooth, before the sun",
        STAGE + SUN + "void trans m 0 0 7 .8 .8 .6 .04 0 .5 .4\n" + HANGING,
        sensors=UNDER,
        view=UNDERSIDE,
    ),
    Case(
        "plastic2",
        "`plastic2`, α = 0.08 and 0.25",
        STAGE + LIGHT + "void plastic2 m 4 1 0 0 . 0 6 .3 .3 .4 .1 .08 .25\n" + PLATE,
    ),
    Case(
        "metal2",
        "`metal2`, α = 0.3 and 0.1, turned",
        STAGE + LIGHT + "void metal2 m 6 1 1 0 . -rz 20 0 6 .6 .7 .5 .7 .3 .1\n" + PLATE,
        pixel_rays=24,
        repeats=64,
    ),
    Case(
        "ashik2",
        "`ashik2`, exponents 40 and 200",
        STAGE + LIGHT + "void ashik2 m 4 1 0 0 . 0 8 .3 .25 .2 .1 .1 .1 40 200\n" + PLATE,
        pixel_rays=24,
    ),
    Case(
        "mirror",
        "`mirror`, that lights the floor",
        STAGE
        + LIGHT
        + "void mirror m 0 0 3 .9 .85 .8\n"
        + "m polygon plate 0 0 12 -.8 .9 .1  .8 .9 .1  .8 1.1 .85  -.8 1.1 .85\n",
        repeats=64,
    ),
    Case(
        "glass",
        "`glass` under sun and even sky",
        STAGE + SUN + SKY + "void glass m 0 0 3 .9 .8 .7\n" + HANGING,
        sensors=UNDER,
        **UNDER_SKY,
    ),
    Case(
        "dielectric",
        "`dielectric`, a slab that absorbs, under an even sky",
        STAGE + SKY + "void dielectric m 0 0 5 .03 .1 .5 1.5 0\n" + SLAB,
        sensors=BELOW,
        **UNDER_SKY,
    ),
    Case(
        "interface",
        "`interface`, water on a slab, both absorb",
        STAGE
        + SKY
        + "void interface m 0 0 8 .03 .1 .5 1.5  .1 .2 .3 1.33\n"
        + SLAB
        + "void dielectric w 0 0 5 .1 .2 .3 1.33 0\n"
        + WATER,
        sensors=BELOW,
        **UNDER_SKY,
    ),
)
"""The scenes."""
