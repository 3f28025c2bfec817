"""A scene for each type of light."""

from .case import GREY, STAGE, Case

LAMP = "polygon lamp 0 0 12 -.4 -.3 1.8  -.4 .3 1.8  .4 .3 1.8  .4 -.3 1.8\n"

CONE = """void spotlight beam 0 0 7 60 60 60 70 .3 .2 -1
beam ring lamp 0 0 8 0 0 1.8 0 0 -1 0 .1
"""

ILLUM = """void glow bright 0 0 4 2 2 4 0
bright source sky 0 0 4 0 0 1 180
void plastic dark 0 0 5 .1 .1 .1 0 0
dark polygon ceiling 0 0 30 -2 -2 1.8  -2 2 1.8  2 2 1.8  2 -2 1.8  -2 -2 1.8
 -.4 -.3 1.8  .4 -.3 1.8  .4 .3 1.8  -.4 .3 1.8  -.4 -.3 1.8
void illum opening 1 void 0 3 9 7 5
opening """

OVERCAST = """!gensky -ang 40 20 -c -B 80
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
"""

CLEAR = """!gensky -ang 35 -60 +s -t 3
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
"""

PEREZ = """!gendaylit -ang 40 30 -W 500 200
skyfunc glow sky_glow 0 0 4 1 1 1 0
sky_glow source sky 0 0 4 0 0 1 180
skyfunc glow ground_glow 0 0 4 1 .9 .7 0
ground_glow source ground 0 0 4 0 0 -1 180
"""

UNDER_SKY = {"divisions": 1024, "repeats": 16, "pixel_rays": 16, "pixel_divisions": 16, "bounces": 5}

LIGHTS = (
    Case("light-polygon", "`light` on a polygon", STAGE + "void light l 0 0 3 20 18 15\nl " + LAMP),
    Case(
        "light-sphere",
        "`light` on a sphere",
        STAGE + "void light l 0 0 3 60 60 60\nl sphere lamp 0 0 4 0 0 1.4 .15\n",
        view="-vtv -vp 0 -3.6 1.5 -vd 0 3.8 -1.8 -vu 0 0 1 -vh 40 -vv 30",
        repeats=3000,
        divisions=9,
        pixel_rays=64,
    ),
    Case(
        "sun",
        "`source` of half a degree",
        STAGE + "void light l 0 0 3 5e6 4.8e6 4.5e6\nl source sun 0 0 4 .4 -.5 .8 .533\n",
    ),
    Case(
        "sun-mirror",
        "`source` of half a degree behind the wall, in a `mirror` before it",
        STAGE
        + "void light l 0 0 3 5e6 4.8e6 4.5e6\nl source sun 0 0 4 .2 .8 .35 .533\n"
        + "void mirror silver 0 0 3 .9 .85 .8\n"
        + "silver polygon m 0 0 12 1.5 -1.8 .1  -1.5 -1.8 .1  -1.5 -1.8 3  1.5 -1.8 3\n",
        view="-vtv -vp 3.5 -1 1.5 -vd -3.5 1.5 -1 -vu 0 0 1 -vh 46 -vv 40",
    ),
    Case("glow", "`glow` with a radius", STAGE + "void glow l 0 0 4 20 18 15 50\nl " + LAMP),
    Case("spotlight", "`spotlight` of 70°", STAGE + CONE),
    Case(
        "illum",
        "`illum` before a sky, seen as void",
        STAGE + ILLUM + LAMP,
        view="-vtv -vp 0 -1.9 .5 -vd 0 1 .2 -vu 0 0 1 -vh 60 -vv 60",
    ),
    Case("sky-overcast", "CIE overcast sky (gensky -c)", STAGE + OVERCAST, **UNDER_SKY),
    Case("sky-clear", "CIE clear sky and sun (gensky +s)", STAGE + CLEAR, **UNDER_SKY),
    Case("sky-perez", "Perez sky, sun and ground (gendaylit)", STAGE + PEREZ, **UNDER_SKY),
)
"""The scenes."""

__all__ = ["GREY", "LAMP", "LIGHTS", "PEREZ"]
