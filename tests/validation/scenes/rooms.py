"""Rooms with a window under a sky."""

from .case import Case
from .lights import PEREZ
from .tables import PEAK, table

ROOM = """void plastic white 0 0 5 .7 .7 .7 0 0
void plastic brown 0 0 5 .25 .2 .15 0 0
void plastic outside 0 0 5 .2 .2 .2 0 0
brown polygon floor 0 0 12 0 0 0  4 0 0  4 5 0  0 5 0
white polygon ceiling 0 0 12 0 0 2.8  0 5 2.8  4 5 2.8  4 0 2.8
white polygon south 0 0 12 0 0 0  0 0 2.8  4 0 2.8  4 0 0
white polygon west 0 0 12 0 0 0  0 5 0  0 5 2.8  0 0 2.8
white polygon east 0 0 12 4 0 0  4 0 2.8  4 5 2.8  4 5 0
white polygon north 0 0 30 0 5 0  4 5 0  4 5 2.8  0 5 2.8  0 5 0
 .4 5 .6  .4 5 2.6  3.6 5 2.6  3.6 5 .6  .4 5 .6
"""

OPENING = "polygon window 0 0 12 .4 5 .6  3.6 5 .6  3.6 5 2.6  .4 5 2.6\n"

INSIDE = ((2.0, 3.5, 0.8, 0.0, 0.0, 1.0), (2.0, 1.2, 0.8, 0.0, 0.0, 1.0), (2.0, 0.1, 1.5, 0.0, 1.0, 0.0))
"""On two tables, and on the wall that faces the window."""

EYE = "-vtv -vp 2 .3 1.6 -vd 0 1 -.35 -vu 0 0 1 -vh 60 -vv 50"

BLIND = "void trans m 0 0 7 .8 .8 .8 0 .25 .35 .7\n"
"""What a screen of glass fibre is like: a broad lobe and a diffuse part."""

DEEP = {
    "sensors": INSIDE,
    "view": EYE,
    "bounces": 16,
    "divisions": 2048,
    "repeats": 16,
    "samples": 1 << 17,
    "pixel_samples": 64,
    "pixel_rays": 16,
    "pixel_divisions": 36,
}

ROOMS = (
    Case(
        "room-perez",
        "room, `glass` in the window, Perez sky",
        PEREZ + ROOM + "void glass pane 0 0 3 .96 .96 .96\npane " + OPENING,
        **DEEP,
    ),
    Case(
        "room-blind",
        "room, `BSDF` of a screen in the window, Perez sky",
        PEREZ + ROOM + "void BSDF m 6 0 m.xml 0 0 1 . 0 0\nm " + OPENING,
        files={"m.xml": table(BLIND, "radiance-klems")},
        **DEEP,
    ),
    Case(
        "room-absdf",
        "room, `aBSDF` of a curtain in the window, Perez sky",
        PEREZ + ROOM + "void aBSDF m 5 m.xml 0 0 1 . 0 0\nm " + OPENING,
        files=PEAK,
        approximate={"picture": 0.02},
        **DEEP,
    ),
)
"""The scenes."""
