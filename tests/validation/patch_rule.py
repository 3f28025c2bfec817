"""Refined patches over a narrow lobe: what their radius and their grading cost, measured without noise."""

from __future__ import annotations

import numpy as np
from gonio import _native

from .line_pitch import QUIET

ALPHA = 0.05
WIDTH = np.degrees(2.0 * ALPHA)
"""1/e half width of the lobe in the plane of incidence, degrees."""

BASE = 8.0
"""Pitch of the base, degrees: 1.4 lobe widths."""


def patch_errors(
    *, radius: float, pitch: float, growth: float, phases: int = 8
) -> tuple[np.ndarray, np.ndarray]:
    """Relative errors of the DHR that processing gives, and readings within the patch.

    Lengths are in units of the lobe's width: `radius` of the patch, `pitch` at its centre; `growth` is that
    of the pitch per distance. Incidences about 45°, as many as `phases`, move the lobe over the base.
    """
    model = _native.analytic([{"model": "ward-gmd", "rho": 0.5, "alpha": ALPHA}])
    incidences = [(45.0 + BASE * k / phases, 0.0) for k in range(phases)]
    parts = {"patch": (radius * WIDTH, pitch * WIDTH, growth, 1.0)} if radius > 0.0 else {"patch": None}
    records = _native.simulate(
        model,
        incidences=incidences,
        components=["reflection"],
        seed=1,
        settings={
            **QUIET,
            "beam_radius": 0.05,
            "aperture": 0.05,
            "pitch_across": BASE,
            "pitch_along": BASE,
            "jitter": 0.0,
            "theta_max": 89.0,
        },
        parts=parts,
    )
    kinds = {k: [r for r in records if r.kind == k] for k in ("sample", "beam", "dark")}
    found = _native.process(kinds["sample"], beam=kinds["beam"], dark=kinds["dark"])
    errors, readings = [], []
    for s in found.slices:
        truth = _native.directional_albedo(model, theta_i=s.theta_i, phi_i=s.phi_i, component="reflection")
        errors.append(s.integrals[0].value / truth - 1.0)
        readings.append(len(s))
    return np.array(errors), np.array(readings)


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(x * x)))
