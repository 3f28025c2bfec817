"""Whether what processing claims is what it is off by, on paths and with beams that tell."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np
from gonio.instruments import Instrument

from .loop_closure import instrument, material, measured


@dataclasses.dataclass(frozen=True)
class Claims:
    """Root mean squares, relative.

    Of readings within 5 degrees of the mirror direction, over the highest DSF there, and of DHRs.
    """

    error: float
    claim: float
    dhr_error: float
    dhr_claim: float


def bench(settings: dict[str, float], pitches: float) -> Instrument:
    """Without errors of gain and drift, which only the calibration's claim covers; pitches multiplied."""
    it = instrument().with_settings({"lamp_drift": 0.0, **settings})
    across, along = (pitches * it.settings[k] for k in ("pitch_across", "pitch_along"))
    regions = [
        (around, at, (radius, pitches * pitch, *rest))
        for around, at, (radius, pitch, *rest) in it.parts["regions"]
    ]
    ranges = [(scale, noise, 0.0) for scale, noise, _ in it.parts["ranges"]]
    return dataclasses.replace(
        it.with_settings({"pitch_across": min(across, 28.0), "pitch_along": along}),
        parts={**it.parts, "regions": regions, "ranges": ranges},
        u_calibration=0.0,
    )


def claims(name: str, settings: dict[str, float], pitches: float, *, seeds: Iterable[int]) -> Claims:
    """Errors against the material's own DSF, and what processing claims."""
    it, device = material(name), bench(settings, pitches)
    error, claim, whole, stated = [], [], [], []
    for seed in seeds:
        for s in measured(it, device, seed=seed).slices:
            t, ti = np.radians(s.theta_s), np.radians(s.theta_i)
            turned = np.radians(s.phi_s - s.phi_i - 180.0)
            near = (
                np.cos(t) * np.cos(ti) + np.sin(t) * np.sin(ti) * np.cos(turned) > np.cos(np.radians(5))
            ) & (s.flags == 0)
            truth = it.dsf(theta_i=s.theta_i, phi_i=s.phi_i, theta_s=s.theta_s[near], phi_s=s.phi_s[near])
            error.append((s.dsf[near] - truth) / truth.max())
            claim.append(s.u_dsf[near] / truth.max())
            for i in s.integrals:
                dhr = it.directional_hemispherical(theta_i=s.theta_i, phi_i=s.phi_i, side=i.side)
                whole.append(i.value / dhr - 1.0)
                stated.append(i.u / dhr)

    def rms(parts: list) -> float:
        return float(np.sqrt(np.mean(np.square(np.hstack(parts)))))

    return Claims(rms(error), rms(claim), rms(whole), rms(stated))
