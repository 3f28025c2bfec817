"""Readings against a reference: the known truth of a simulation, or a model built from the readings."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gonio._drawing.directions import component_of
from gonio._drawing.numbers import angle, percent
from gonio._drawing.shapes import BsdfLike, Floats, Snapshot, unusable
from gonio._native import Bsdf, directional_albedo
from gonio.reporting.wording import channel_label

if TYPE_CHECKING:
    from gonio.reporting.drawn import DrawnSlice


@dataclass(frozen=True)
class Reference:
    """A scattering function to compare with: `name` in the payload, `label` for the reader."""

    name: str
    label: str
    bsdf: BsdfLike

    def dsf(self, s: Snapshot, theta_s: Floats, phi_s: Floats) -> Floats:
        """DSF in 1/sr of the reference at receiver directions (degrees) of the slice's incidence and channel.

        NaN where the angles are NaN. A reference of one channel answers for all.
        """
        known = np.isfinite(theta_s) & np.isfinite(phi_s)
        out = np.full(len(theta_s), np.nan)
        if known.any():
            channels = list(self.bsdf.channels)
            f = self.bsdf.eval(
                theta_i=s.theta_i,
                phi_i=s.phi_i,
                theta_s=theta_s[known],
                phi_s=phi_s[known],
                channel=channels[0] if len(channels) == 1 else s.channel,
            )
            out[known] = np.asarray(f, dtype=float) * np.abs(np.cos(np.radians(theta_s[known])))
        return out

    def along(self, s: Snapshot, extended: Floats) -> Floats:
        """DSF of the reference at extended polar angles (degrees) in the plane of incidence."""
        plane = (s.phi_i + 180.0) % 360.0
        theta = np.where(extended < 0.0, -extended, np.where(extended > 180.0, 360.0 - extended, extended))
        opposite = (extended < 0.0) | (extended > 180.0)
        return self.dsf(s, theta, np.where(opposite, (plane + 180.0) % 360.0, plane) + 0.0 * extended)


def hemispherical_truth(truth: BsdfLike | None, s: Snapshot, side: str) -> float | None:
    """DHR or DHT of a known scattering function at the incidence of a slice; None where it cannot be told."""
    if not isinstance(truth, Bsdf):
        return None
    return directional_albedo(
        truth,
        theta_i=s.theta_i,
        phi_i=s.phi_i,
        component=component_of(s.theta_i, side),
        channel=None if len(truth.channels) == 1 else s.channel,
    )


def residual_rows(drawn: list["DrawnSlice"], references: list[Reference]) -> list[dict[str, str]]:
    """One row a slice and reference: bias and spread of the readings against it, above the noise floor."""
    return [_row(d, r) for r in references for d in drawn]


def _row(d: "DrawnSlice", reference: Reference) -> dict[str, str]:
    s = d.slice
    floor = max(d.floor or 0.0, 0.0)
    rows = np.flatnonzero(~unusable(s.flags, s.dsf) & (s.dsf > floor))
    expected = reference.dsf(s, s.theta_s[rows], s.phi_s[rows])
    good = np.isfinite(expected) & (expected > floor)
    rows, expected = rows[good], expected[good]
    row = {
        "reference": reference.label,
        "theta_i": angle(s.theta_i),
        "phi_i": angle(s.phi_i),
        "channel": channel_label(s.channel),
    }
    if len(rows) == 0:
        return row | {"n": "0", "bias": "—", "median": "—", "p95": "—", "within": "—"}
    relative = s.dsf[rows] / expected - 1.0
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = np.abs(s.dsf[rows] - expected) <= 1.96 * s.u_dsf[rows]
    return row | {
        "n": f"{len(rows):,}".replace(",", "\u202f"),
        "bias": percent(float(np.median(relative))),
        "median": percent(float(np.median(np.abs(relative)))),
        "p95": percent(float(np.percentile(np.abs(relative), 95.0))),
        "within": percent(float(np.mean(inside)), 1),
    }
