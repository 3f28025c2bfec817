"""One slice made ready for drawing: surfaces, profile, noise floor and counts."""

from dataclasses import dataclass

import numpy as np

from gonio._drawing.directions import SIDES
from gonio._drawing.mesh import MOST_TRIANGULATED, Mesh, triangulate
from gonio._drawing.noise import noise_floor
from gonio._drawing.section import Profile, section
from gonio._drawing.shapes import SliceLike, Snapshot, snapshot, unusable
from gonio._drawing.thinning import thin
from gonio._native import FLAGS

MOST_DRAWN = 120_000
"""Readings drawn in a whole report."""

MOST_A_HEMISPHERE = 7_000
"""Readings drawn in one hemisphere of one slice."""

LEAST_A_HEMISPHERE = 250
"""Readings of one hemisphere that are drawn however many slices there are."""


@dataclass(frozen=True)
class DrawnSlice:
    """A slice with what the page draws of it.

    `key` is its position in the measurement, `meshes` the drawn surfaces (thinned), `profile` the section
    through all its readings, `floor` the noise floor in 1/sr or None, `peak` the largest usable DSF or NaN.
    `thinned` tells whether fewer directions are drawn than were read.
    """

    key: int
    slice: Snapshot
    meshes: dict[str, Mesh]
    profile: Profile
    floor: float | None
    peak: float
    readings: int
    drawn: int
    thinned: bool
    negative: int
    below_noise: int
    unusable: int


def draw_all(slices: list[SliceLike]) -> list[DrawnSlice]:
    """Make every slice ready, sharing the budget of drawn readings, ordered by incidence and channel."""
    most = int(np.clip(MOST_DRAWN / max(2 * len(slices), 1), LEAST_A_HEMISPHERE, MOST_A_HEMISPHERE))
    drawn = [draw(slice_, key, most) for key, slice_ in enumerate(slices)]
    return sorted(drawn, key=lambda d: (round(d.slice.phi_i, 4), round(d.slice.theta_i, 4), d.key))


def draw(slice_: SliceLike, key: int, most: int) -> DrawnSlice:
    """Make one slice ready; at most about `most` readings of each hemisphere are kept for the surfaces."""
    fetched = snapshot(slice_)
    full = {side: triangulate(fetched, side) for side in SIDES}
    full = {side: mesh for side, mesh in full.items() if len(mesh.rows)}
    bad = unusable(fetched.flags, fetched.dsf)
    usable = fetched.dsf[~bad]
    floor = noise_floor(fetched)
    peak = float(usable.max()) if len(usable) else float("nan")
    scale = max(floor or 0.0, abs(peak) * 1e-4 if np.isfinite(peak) else 0.0, 1e-12)
    meshes = {side: thin(mesh, fetched.dsf, most=most, floor=scale) for side, mesh in full.items()}
    flags = fetched.flags.astype(np.int64)
    return DrawnSlice(
        key=key,
        slice=fetched,
        meshes=meshes,
        profile=section(fetched, full),
        floor=floor,
        peak=peak,
        readings=len(fetched.dsf),
        drawn=sum(len(mesh.rows) for mesh in meshes.values()),
        thinned=any(len(full[side].rows) > len(mesh.rows) for side, mesh in meshes.items())
        or len(usable) > MOST_TRIANGULATED,
        negative=int((usable < 0.0).sum()),
        below_noise=int(((flags & FLAGS["below_noise"]) != 0).sum()),
        unusable=int(bad.sum()),
    )
