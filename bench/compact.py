"""10,000,000 evaluations of a measured material: the compact model of gonio against `measured` of Mitsuba 3.

The material is isotropic, in red, green and blue: a diffuse part, a glossy lobe with Beckmann facets and a
broad one of another colour. Mitsuba reads the RGL file that gonio writes of it, gonio the compact model of
the same material. Both take float32 directions (3, n) and give three channels (3, n), on one thread: for one
direction of incidence (`ratio`) and for one a pair (`ratio_each`). CPU seconds of this process, medians of
pairs that alternate in one run. `bytes` are those of the two files; `rel_l1_ours` and `rel_l1_peer` the
relative L1 errors of both against the material, mean of three channels over 15 to 75 degrees.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import gonio
import numpy as np
from gonio import analytic

from bench._mitsuba import COUNT, Array, hemisphere, mitsuba, record
from bench.eval import WI

IDS = ("compact-eval-vs-mitsuba-measured",)
COLOURS = ("red", "green", "blue")
THETA_I = (15.0, 30.0, 45.0, 60.0, 75.0)


def material() -> gonio.Bsdf:
    """Brown paint: diffuse, a narrow lobe, and a broad one that is not white."""
    return analytic(
        {"model": "oren-nayar", "rho": dict(zip(COLOURS, (0.4, 0.2, 0.1), strict=True)), "sigma": 20.0},
        {"model": "beckmann", "f0": dict.fromkeys(COLOURS, 0.04), "alpha": 0.12},
        {"model": "ward-gmd", "rho": dict(zip(COLOURS, (0.06, 0.05, 0.03), strict=True)), "alpha": 0.4},
    )


def by_mitsuba(mi: Any, bsdf: Any, wi: Array, ws: Array) -> Array:
    """Numpy in, numpy out: f cos."""
    import drjit as dr  # noqa: PLC0415

    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*map(float, wi)) if wi.ndim == 1 else mi.Vector3f(wi)
    # the plugin tells colours from wavelengths by the variant; RGB files need none
    found: Array = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(ws)).numpy()
    return found


def error(truth: gonio.Bsdf, values: Any) -> float:
    """Relative L1 error of `values(wi, ws)`, which give f cos of three channels."""
    ws = hemisphere(200_000, seed=5)
    ws = np.ascontiguousarray(ws[:, ws[2] > 0.03])
    errors = []
    for theta in np.radians(THETA_I):
        wi = np.array([np.sin(theta), 0.0, np.cos(theta)], np.float32)
        wanted = truth.eval_directions(wi=wi, ws=ws) * ws[2]
        errors.append(np.abs(values(wi, ws) - wanted).sum(axis=1) / wanted.sum(axis=1))
    return float(np.mean(errors))


def run() -> list[dict[str, Any]]:
    mi = mitsuba("llvm_ad_rgb")
    if mi is None:
        return []
    truth = material()
    with tempfile.TemporaryDirectory() as where:
        ours_file, peer_file = Path(where) / "ours.nc", Path(where) / "peer.bsdf"
        gonio.reduce(truth, out=ours_file, components=[("front", "reflection")], target=0.01)
        gonio.export(truth, to="rgl-bsdf", out=peer_file)
        sizes = [ours_file.stat().st_size, peer_file.stat().st_size]
        model = gonio.read_bsdf(ours_file)
        peer = mi.load_dict({"type": "measured", "filename": str(peer_file)})
    ws, each = hemisphere(COUNT), hemisphere(COUNT, seed=7)
    held = np.empty((len(COLOURS), COUNT), np.float32)

    def timed(wi: Array) -> dict[str, Any]:
        return record(
            IDS[0],
            f"Mitsuba {mi.__version__} llvm_ad_rgb, measured",
            lambda: model.eval_directions(wi=wi, ws=ws, out=held),
            lambda: by_mitsuba(mi, peer, wi, ws),
        )

    one, pairs = timed(WI), timed(each)
    return [
        one
        | {
            "ours_each": pairs["ours"],
            "peer_each": pairs["peer"],
            "ratio_each": pairs["ratio"],
            "bytes": sizes,
            "rel_l1_ours": error(truth, lambda wi, w: model.eval_directions(wi=wi, ws=w) * w[2]),
            "rel_l1_peer": error(truth, lambda wi, w: by_mitsuba(mi, peer, wi, w)),
        }
    ]
