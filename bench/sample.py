"""10,000,000 sampled directions, float32 arrays in and float32 arrays out: gonio against Mitsuba 3.

GGX of one width with the exact Fresnel reflectance of aluminium in three channels (`ggx-conductor` against
`roughconductor`), visible normals, one direction of incidence. Both take uniform numbers (3, n), Mitsuba
looks at two of them, and give directions (3, n), weights (3, n) and densities (n), on one thread. CPU
seconds of this process, medians of pairs that alternate in one run. `scalar_rgb` is Mitsuba's scalar
variant: a call a direction from Python.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from gonio import analytic

from bench._mitsuba import COUNT, SCALAR_COUNT, Array, mitsuba, record, with_scalar
from bench._timing import cpu_seconds
from bench.eval import ALPHA, ALUMINIUM, WI, roughconductor

IDS = ("sample-ggx-vs-mitsuba-llvm",)


def by_mitsuba(mi: Any, bsdf: Any, u: Array) -> tuple[Array, Array, Array]:
    """Numpy in, numpy out."""
    import drjit as dr  # noqa: PLC0415

    si = dr.zeros(mi.SurfaceInteraction3f)
    si.wi = mi.Vector3f(*map(float, WI))
    number = mi.Point3f(u)
    drawn, weight = bsdf.sample(mi.BSDFContext(), si, number.z, mi.Point2f(number.x, number.y))
    dr.eval(drawn.wo, drawn.pdf, weight)
    return drawn.wo.numpy(), weight.numpy(), drawn.pdf.numpy()


def scalar_seconds() -> float:
    """CPU seconds of the scalar variant for `COUNT` directions, from fewer."""
    mi = mitsuba("scalar_rgb")
    assert mi is not None
    bsdf, si, context = roughconductor(mi), mi.SurfaceInteraction3f(), mi.BSDFContext()
    si.wi = mi.Vector3f(*map(float, WI))
    rng = np.random.default_rng(1)
    numbers = [(float(a), mi.Point2f(float(b), float(c))) for a, b, c in rng.random((SCALAR_COUNT, 3))]

    def call() -> None:
        for one, two in numbers:
            bsdf.sample(context, si, one, two)

    call()
    return cpu_seconds(call) * COUNT / SCALAR_COUNT


def run() -> list[dict[str, Any]]:
    mi = mitsuba("llvm_ad_rgb")
    if mi is None:
        return []
    u = np.random.default_rng(20261122).random((3, COUNT), dtype=np.float32)
    model = analytic({"model": "ggx-conductor", **ALUMINIUM, "alpha": ALPHA})
    peer = roughconductor(mi)
    # The two map the same numbers to different directions: what they must share are the means.
    few = np.ascontiguousarray(u[:, :1_000_000])
    ours = model.sample_directions(wi=WI, u=few)
    ws, weight, _ = by_mitsuba(mi, peer, few)
    np.testing.assert_allclose(ours["weight"].mean(axis=1), weight.mean(axis=1), rtol=0.03)
    mean = (ours["weight"] * np.nan_to_num(ours["ws"])).mean(axis=1)
    np.testing.assert_allclose(mean, (weight * ws).mean(axis=1), atol=0.02)
    found = record(
        IDS[0],
        f"Mitsuba {mi.__version__} llvm_ad_rgb, roughconductor",
        lambda: model.sample_directions(wi=WI, u=u),
        lambda: by_mitsuba(mi, peer, u),
    )
    return [with_scalar(found, scalar_seconds())]
