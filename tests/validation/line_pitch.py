"""Lines across a narrow lobe: what their pitch costs, measured without noise."""

from __future__ import annotations

import numpy as np
from gonio import _native

ALPHA = 0.03
WIDTH = 2.0 * ALPHA
"""1/e half width of the lobe in the plane of incidence, radians; beam and aperture are narrow beside it."""

QUIET = {
    "noise_readout": 0.0,
    "noise_relative": 0.0,
    "dark_level": 0.0,
    "dark_swing": 0.0,
    "pointing": 0.0,
    "shadow": 0.0,
    "beam_radius": 0.006,
    "aperture": 0.01,
    "spot_diameter": 0.0,
}


def line_sums(ratio: float, *, jitter: float, phases: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Relative errors of the DHR summed over rings, and losses of the highest reading.

    Rings of constant theta_s are `ratio` lobe widths apart and cross the lobe; the weight of one reaches half
    way to its neighbours. Incidences about 45°, as many as `phases`, move the lobe over one pitch.
    """
    pitch = np.degrees(ratio * WIDTH)
    model = _native.analytic([{"model": "ward-gmd", "rho": 0.5, "alpha": ALPHA}])
    incidences = [(45.0 + pitch * k / phases, 0.0) for k in range(phases)]
    scans = _native.simulate(
        model,
        incidences=incidences,
        components=["reflection"],
        seed=seed,
        settings={**QUIET, "pitch_across": pitch, "pitch_along": 0.1, "jitter": jitter},
        parts={"patch": None},
        beam_scans=1,
    )
    errors, losses = [], []
    for s in (s for s in scans if s.kind == "sample"):
        turns = np.flatnonzero(np.abs(np.diff(s.theta_s)) > 0.2 * pitch) + 1
        rings = [np.radians(np.mean(t)) for t in np.split(s.theta_s, turns)]
        means = [np.mean(v) for v in np.split(s.value, turns)]
        edges = np.concatenate([[0.0], 0.5 * (np.array(rings)[1:] + np.array(rings)[:-1]), [np.pi / 2]])
        widths = np.diff(edges)
        dhr = 2.0 * np.pi * np.sum(widths * np.sin(rings) * means) / 1000.0
        truth = _native.directional_albedo(model, theta_i=s.theta_i, phi_i=0.0, component="reflection")
        errors.append(dhr / truth - 1.0)
        peak = model.eval(theta_i=s.theta_i, phi_i=0.0, theta_s=s.theta_i, phi_s=180.0)
        top = 1000.0 * float(np.ravel(peak)[0]) * np.cos(np.radians(s.theta_i))
        losses.append(1.0 - np.max(s.value) / top)
    return np.array(errors), np.array(losses)
