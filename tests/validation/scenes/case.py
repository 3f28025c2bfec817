"""What a comparison is made of."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

VIEW = "-vtv -vp 0 -3.6 1.5 -vd 0 3.8 -1.3 -vu 0 0 1 -vh 46 -vv 40"
"""The floor and the wall behind it."""

SENSORS = (
    (0.0, -0.4, 0.02, 0.0, 0.0, 1.0),
    (1.2, 0.6, 0.02, 0.0, 0.0, 1.0),
    (-0.6, 1.9, 0.8, 0.0, -1.0, 0.0),
)
"""Two on the floor, one on the wall."""

GREY = "void plastic grey 0 0 5 .4 .35 .3 0 0\n"

STAGE = (
    GREY
    + "grey polygon floor 0 0 12 -2 -2 0  2 -2 0  2 2 0  -2 2 0\n"
    + "grey polygon wall 0 0 12 -2 2 0  2 2 0  2 2 2  -2 2 2\n"
)
"""A floor and a wall at its end."""


@dataclass(frozen=True)
class Case:
    """A scene and how much work both programs put into it.

    `files` are written beside the scene: text, or a function of the path that writes it. `ours` is the file
    that gonio reads where it is not the same. RADIANCE follows `bounces` ambient bounces with `divisions`
    rays at the first, `repeats` times a sensor; `pixel_rays` rays a pixel with `pixel_divisions`. gonio takes
    `samples` paths a sensor and `pixel_samples` a pixel. `approximate` says how much RADIANCE's own
    approximations move a quantity at most, relative.
    """

    name: str
    about: str
    text: str
    sensors: tuple[tuple[float, ...], ...] = SENSORS
    view: str = VIEW
    files: Mapping[str, str | Callable[[Path], None]] = field(default_factory=dict)
    ours: str | None = None
    options: tuple[str, ...] = ()
    size: int = 24
    bounces: int = 3
    divisions: int = 256
    repeats: int = 32
    pixel_rays: int = 8
    pixel_divisions: int = 16
    samples: int = 1 << 16
    pixel_samples: int = 256
    approximate: Mapping[str, float] = field(default_factory=dict)

    def write(self, folder: Path) -> None:
        """The files of the scene; the scene itself is `scene.rad`."""
        for name, content in self.files.items():
            if callable(content):
                content(folder / name)
            else:
                (folder / name).write_text(content)
        (folder / "scene.rad").write_text(self.text)
