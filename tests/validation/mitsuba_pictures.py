"""The same scenes rendered by gonio and by Mitsuba 3, pixel by pixel.

Both render every scene with some seeds; the scatter of a pixel over the seeds is its error, without trust
in what either states. The difference of the means over its error is Student's t (degrees of freedom after
Welch); its normal score z is standard normal where both follow the same light and their noise is normal.
Patches of 2 by 2 pixels are compared: rare bright paths make the noise of a single one skewed. Mitsuba's
sampler is the independent one.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gonio
import numpy as np
from numpy.typing import NDArray
from scipy import stats

Array = NDArray[np.float64]
WEIGHTS = np.array([0.265074, 0.670115, 0.064811])
"""Luminance of red, green and blue over that of white in Radiance."""
LLVM = (
    "/usr/lib/x86_64-linux-gnu/libLLVM.so.19.1",
    "/usr/lib/llvm-19/lib/libLLVM.so.19.1",
    "/usr/lib/x86_64-linux-gnu/libLLVM.so.20.1",
)
"""Where Debian and Ubuntu put an LLVM that Mitsuba works with: 15 and 16 abort the interpreter."""
BOUNCES = 63
"""Surfaces of a path; Mitsuba's max_depth counts the light too, and panes that light goes through."""


@dataclass(frozen=True)
class Twin:
    """One scene for both: gonio's with its view, Mitsuba's for a number of pixels on a side."""

    name: str
    title: str
    ours: Callable[[], tuple[Any, str]]
    theirs: Callable[[Any, int], dict[str, Any]]


@dataclass(frozen=True)
class Agreement:
    """Normal scores of all patches with noise, and the means of both pictures.

    `even_z` is the difference of the pictures averaged over the patches, each weighted by one over its
    error, over the scatter of that average from seed to seed. The mean of `z` tells less: patches of a tile
    that shares paths are not independent, and where noise is skewed the mean of t is not 0.
    """

    z: Array
    even_z: float
    means: tuple[float, float]
    mean_error: float

    @property
    def mean_z(self) -> float:
        """Of the whole picture."""
        return (self.means[0] - self.means[1]) / self.mean_error

    @property
    def beyond_3(self) -> float:
        """Share of the patches; 0.27 % of a standard normal."""
        return float((np.abs(self.z) > 3.0).mean())

    @property
    def kolmogorov(self) -> float:
        """p of the distribution of z being the standard normal."""
        return float(stats.kstest(self.z, "norm").pvalue)


def pictures(mitsuba: Any, twin: Twin, *, size: int, samples: int, runs: int) -> tuple[Array, Array]:
    """Luminances over those of white, gonio's and Mitsuba's: `runs` seeds of `samples` paths a pixel."""
    scene, view = twin.ours()
    seeds = range(1, runs + 1)
    options: dict[str, Any] = {"view": view, "size": size, "samples": samples, "bounces": BOUNCES}
    ours = [gonio.render(scene, seed=seed, **options).radiance @ WEIGHTS for seed in seeds]
    peer = mitsuba.load_dict(twin.theirs(mitsuba, size))
    theirs = [
        np.array(mitsuba.render(peer, spp=samples, seed=seed), dtype=np.float64) @ WEIGHTS for seed in seeds
    ]
    return np.array(ours), np.array(theirs)


def ready() -> Any:
    """Mitsuba in its compiled variant, or None: LLVM is missing.

    Raises
    ------
    ImportError
        No wheel for this platform.
    """
    import mitsuba  # noqa: PLC0415

    found = os.environ.get("DRJIT_LIBLLVM_PATH") or next((p for p in LLVM if Path(p).exists()), None)
    if found is None:
        return None
    os.environ["DRJIT_LIBLLVM_PATH"] = found
    mitsuba.set_variant("llvm_ad_rgb")
    return mitsuba


def agreement(ours: Array, theirs: Array) -> Agreement:
    """Of pictures by seed, shape (runs, height, width), both sides even."""
    ours, theirs = (_patches(p) for p in (ours, theirs))
    n, m = len(ours), len(theirs)
    a, b = ours.var(axis=0, ddof=1) / n, theirs.var(axis=0, ddof=1) / m
    # Less noise than this cannot be told from single precision and the steps of a picture of the sky.
    noisy = np.sqrt(a + b) > 1e-4 * ours.mean(axis=0)
    a, b = a[noisy], b[noisy]
    t = (ours.mean(axis=0) - theirs.mean(axis=0))[noisy] / np.sqrt(a + b)
    freedom = (a + b) ** 2 / (a**2 / (n - 1) + b**2 / (m - 1))
    # By the upper tail of |t|: the cumulative distribution is 1 to all digits far out.
    z = np.sign(t) * stats.norm.isf(stats.t.sf(np.abs(t), freedom))
    means = [p.mean(axis=(1, 2)) for p in (ours, theirs)]
    error = np.sqrt(sum(x.var(ddof=1) / len(x) for x in means))
    even_z = _even(ours[:, noisy], theirs[:, noisy])
    return Agreement(z, even_z, (float(means[0].mean()), float(means[1].mean())), float(error))


def _patches(pictures: Array) -> Array:
    runs, height, width = pictures.shape
    return pictures.reshape(runs, height // 2, 2, width // 2, 2).mean(axis=(2, 4))


def _even(ours: Array, theirs: Array) -> float:
    """Of pictures by seed, shape (runs, patches): see `Agreement.even_z`."""
    difference, variance = 0.0, 0.0
    # The error of a patch goes with its value where noise is skewed: weights are those of other seeds.
    for half in (0, 1):
        own, other = ([p[k::2] for p in (ours, theirs)] for k in (half, 1 - half))
        weight = 1.0 / np.sqrt(sum(p.var(axis=0, ddof=1) / len(p) for p in other))
        means = [(p * weight).mean(axis=1) for p in own]
        difference += means[0].mean() - means[1].mean()
        variance += sum(x.var(ddof=1) / len(x) for x in means)
    return float(difference / np.sqrt(variance))


def _camera(mi: Any, size: int, eye: list[float], at: list[float], fov: float) -> dict[str, Any]:
    return {
        "type": "perspective",
        "fov": fov,
        "to_world": mi.ScalarTransform4f().look_at(eye, at, [0, 0, 1]),
        "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}},
        "sampler": {"type": "independent"},
    }


def _frame(mi: Any, size: int, eye: list[float], at: list[float], fov: float) -> dict[str, Any]:
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": BOUNCES + 1, "rr_depth": 5},
        "sensor": _camera(mi, size, eye, at, fov),
    }


def _view(eye: list[float], at: list[float], fov: float) -> str:
    towards = np.subtract(at, eye)
    return f"-vtv -vp {_words(eye)} -vd {_words(towards)} -vu 0 0 1 -vh {fov} -vv {fov}"


def _words(numbers: Any) -> str:
    return " ".join(f"{x:.9g}" for x in np.ravel(numbers))


def _read(text: str, **files: str) -> Any:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "scene.rad").write_text(text)
        for name, content in files.items():
            (Path(folder) / f"{name}.cal").write_text(content)
        scene, warnings = gonio.read_scene(Path(folder) / "scene.rad")
    if warnings:
        raise AssertionError(warnings)
    return scene


def _block(size: list[float], turn: float, at: list[float]) -> list[Any]:
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))

    def corner(k: int) -> list[float]:
        x, y, z = size[0] * (k & 1), size[1] * (k >> 1 & 1), size[2] * (k >> 2)
        return [c * x - s * y + at[0], s * x + c * y + at[1], z + at[2]]

    faces = ([0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5])
    return [("white", [corner(k) for k in face]) for face in faces]


COLOURS = {"white": [0.75] * 3, "red": [0.63, 0.06, 0.05], "green": [0.15, 0.48, 0.09], "lamp": [0.0] * 3}
CORNELL: list[Any] = [
    ("white", [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]),
    ("white", [[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]),
    ("white", [[0, 1, 0], [1, 1, 0], [1, 1, 1], [0, 1, 1]]),
    ("red", [[0, 0, 0], [0, 1, 0], [0, 1, 1], [0, 0, 1]]),
    ("green", [[1, 0, 0], [1, 0, 1], [1, 1, 1], [1, 1, 0]]),
    ("lamp", [[0.35, 0.35, 0.998], [0.35, 0.65, 0.998], [0.65, 0.65, 0.998], [0.65, 0.35, 0.998]]),
    *_block([0.3, 0.3, 0.6], 18, [0.15, 0.5, 0.001]),
    *_block([0.3, 0.3, 0.3], -17, [0.58, 0.2, 0.001]),
]
CORNELL_EYE: list[float] = [0.5, -1.35, 0.5]


def _cornell() -> tuple[Any, str]:
    text = "void light lamp 0 0 3 15 15 15\n"
    for name in ("white", "red", "green"):
        text += f"void plastic {name} 0 0 5 {_words(COLOURS[name])} 0 0\n"
    for k, (name, corners) in enumerate(CORNELL):
        text += f"{name} polygon p{k} 0 0 12 {_words(corners)}\n"
    return _read(text), _view(CORNELL_EYE, [0.5, 0.0, 0.5], 39.0)


def _quad_file(folder: Path, corners: Any) -> dict[str, Any]:
    """A quadrilateral, in a file: a shape with an emitter must be loaded with it."""
    file = folder / "quad.obj"
    lines = [f"v {_words(c)}" for c in corners]
    file.write_text("\n".join([*lines, "f 1 2 3", "f 1 3 4", ""]))
    return {"type": "obj", "filename": str(file), "face_normals": True}


def _diffuse(colour: list[float]) -> dict[str, Any]:
    inner = {"type": "diffuse", "reflectance": {"type": "rgb", "value": colour}}
    return {"type": "twosided", "bsdf": inner}


def _cornell_theirs(mi: Any, size: int) -> dict[str, Any]:
    scene = _frame(mi, size, CORNELL_EYE, [0.5, 0.0, 0.5], 39.0)
    for k, (name, corners) in enumerate(CORNELL):
        with tempfile.TemporaryDirectory() as folder:
            shape: dict[str, Any] = {**_quad_file(Path(folder), corners), "bsdf": _diffuse(COLOURS[name])}
            if name == "lamp":
                shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [15.0] * 3}}
            scene[f"p{k}"] = mi.load_dict(shape)
    return scene


STUDIO_EYE: list[float] = [0.0, -6.5, 3.1]
STUDIO_AT: list[float] = [0.0, 0.0, 0.92]


def _studio(model: dict[str, Any]) -> Callable[[], tuple[Any, str]]:
    def make() -> tuple[Any, str]:
        scene, view = gonio.studio_scene(gonio.analytic(model))
        return scene, view

    return make


def _gradient(mi: Any, level: float, slope: float, horizon: float) -> dict[str, Any]:
    """A sky of radiance `level + slope z` above the height `horizon`, and as there below it."""
    rows, columns = 1024, 8
    # The rows are the pixel centres; Mitsuba's up is y.
    z = np.cos(np.pi * (np.arange(rows) + 0.5) / rows)
    value = level + slope * np.maximum(z, horizon)
    picture = np.repeat(np.repeat(value[:, None, None], columns, axis=1), 3, axis=2).astype(np.float32)
    turned = mi.ScalarTransform4f().rotate([1, 0, 0], 90)
    return {"type": "envmap", "bitmap": mi.Bitmap(picture), "to_world": turned}


def _studio_theirs(bsdf: dict[str, Any]) -> Callable[[Any, int], dict[str, Any]]:
    def make(mi: Any, size: int) -> dict[str, Any]:
        scene = _frame(mi, size, STUDIO_EYE, STUDIO_AT, 24.0)
        back = np.array([-3.0, -2.6, 3.6])
        centre = np.array([-3.0, -2.6, 4.6])
        back /= np.linalg.norm(back)
        across = np.cross(back, [0.0, 0.0, 1.0])
        across /= np.linalg.norm(across)
        along = np.cross(back, across)
        corner = centre - across - along
        lamp = [corner, corner + 2 * along, corner + 2 * along + 2 * across, corner + 2 * across]
        with tempfile.TemporaryDirectory() as folder:
            scene["lamp"] = mi.load_dict(
                {
                    **_quad_file(Path(folder), lamp),
                    "bsdf": _diffuse([0.0] * 3),
                    "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [9.0] * 3}},
                }
            )
        greys = {f"color{k}": {"type": "rgb", "value": [v] * 3} for k, v in enumerate((0.45, 0.25))}
        tiles = {"type": "checkerboard", "to_uv": mi.ScalarTransform4f().scale([24, 24, 1]), **greys}
        scene["plane"] = {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale([18, 18, 1]),
            "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": tiles}},
        }
        scene["ball"] = {"type": "sphere", "center": [0, 0, 1], "radius": 1.0, "bsdf": correlated(mi, bsdf)}
        scene["sky"] = _gradient(mi, 0.1, 0.25, 0.0)
        return scene

    return make


def correlated(mi: Any, bsdf: dict[str, Any]) -> Any:
    """Mitsuba's GGX surface with the height-correlated masking of gonio in reflection, in place of G1 G1."""
    import drjit as dr  # noqa: PLC0415

    class Correlated(mi.BSDF):  # type: ignore[misc, name-defined]
        """The nested surface times the ratio of the maskings."""

        def __init__(self, properties: Any) -> None:
            super().__init__(properties)
            self.nested = mi.load_dict(bsdf)
            self.m_components = [self.nested.flags(k) for k in range(self.nested.component_count())]
            self.m_flags = self.nested.flags()

        def ratio(self, wi: Any, wo: Any) -> Any:
            def masked(w: Any) -> Any:
                slope2 = (w.x * w.x + w.y * w.y) / (w.z * w.z)
                return 0.5 * (dr.sqrt(1.0 + bsdf["alpha"] ** 2 * slope2) - 1.0)

            a, b = masked(wi), masked(wo)
            value = (1.0 + a) * (1.0 + b) / (1.0 + a + b)
            return dr.select(wi.z * wo.z > 0.0, value, 1.0)

        def sample(self, ctx: Any, si: Any, sample1: Any, sample2: Any, active: Any = True) -> Any:
            drawn, weight = self.nested.sample(ctx, si, sample1, sample2, active)
            return drawn, weight * self.ratio(si.wi, drawn.wo)

        def eval(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.nested.eval(ctx, si, wo, active) * self.ratio(si.wi, wo)

        def pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.nested.pdf(ctx, si, wo, active)

        def eval_pdf(self, ctx: Any, si: Any, wo: Any, active: Any = True) -> Any:
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self) -> str:
            return "Correlated"

    name = f"correlated-{bsdf['type']}"
    mi.register_bsdf(name, Correlated)
    return {"type": name}


GLASS_EYE: list[float] = [0.3, -6.0, 2.6]
GLASS_AT: list[float] = [0.0, 0.0, 0.7]


def _glass() -> tuple[Any, str]:
    text = """void brightfunc up 2 up gradient.cal 0 0
up glow g 0 0 4 1 1 1 0
g source sky 0 0 4 0 0 1 360
void plastic grey 0 0 5 .5 .5 .5 0 0
void plastic red 0 0 5 .6 .1 .1 0 0
void dielectric solid 0 0 5 1 1 1 1.5 0
void glass pane 0 0 4 1 1 1 1.52
void mirror silver 0 0 3 .9 .8 .7
grey polygon floor 0 0 12 -8 -8 0 8 -8 0 8 8 0 -8 8 0
solid sphere ball 0 0 4 -.9 0 .8 .7
silver sphere ball2 0 0 4 1 .6 .8 .7
pane polygon p 0 0 12 .2 -1 .1 1.8 -1 .1 1.8 -1 1.6 .2 -1 1.6
red polygon back 0 0 12 -3 2 0 3 2 0 3 2 2 -3 2 2
"""
    return _read(text, gradient="up = .65 + .35*Dz;\n"), _view(GLASS_EYE, GLASS_AT, 36.0)


def _glass_theirs(mi: Any, size: int) -> dict[str, Any]:
    scene = _frame(mi, size, GLASS_EYE, GLASS_AT, 36.0)
    metal = {
        "type": "conductor",
        "material": "none",
        "specular_reflectance": {"type": "rgb", "value": [0.9, 0.8, 0.7]},
    }
    quads: dict[str, tuple[list[list[float]], dict[str, Any]]] = {
        "floor": ([[-8, -8, 0], [8, -8, 0], [8, 8, 0], [-8, 8, 0]], _diffuse([0.5] * 3)),
        "back": ([[-3, 2, 0], [3, 2, 0], [3, 2, 2], [-3, 2, 2]], _diffuse([0.6, 0.1, 0.1])),
        "pane": (
            [[0.2, -1, 0.1], [1.8, -1, 0.1], [1.8, -1, 1.6], [0.2, -1, 1.6]],
            {"type": "thindielectric", "int_ior": 1.52, "ext_ior": 1.0},
        ),
    }
    for name, (corners, bsdf) in quads.items():
        with tempfile.TemporaryDirectory() as folder:
            scene[name] = mi.load_dict({**_quad_file(Path(folder), corners), "bsdf": bsdf})
    solid = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
    scene["ball"] = {"type": "sphere", "center": [-0.9, 0, 0.8], "radius": 0.7, "bsdf": solid}
    scene["ball2"] = {"type": "sphere", "center": [1, 0.6, 0.8], "radius": 0.7, "bsdf": metal}
    scene["sky"] = _gradient(mi, 0.65, 0.35, -1.0)
    return scene


CONDUCTOR = {"model": "ggx-conductor", "alpha": 0.25, "eta": 0.2, "k": 3.0}
DIELECTRIC = {"model": "ggx-dielectric", "alpha": 0.25, "eta": 1.5}
TWINS = (
    Twin("cornell", "Cornell box: diffuse walls, an area light", _cornell, _cornell_theirs),
    Twin(
        "conductor",
        "ball of a rough conductor (GGX) on a chequered plane, area light and sky",
        _studio(CONDUCTOR),
        _studio_theirs(
            {
                "type": "roughconductor",
                "distribution": "ggx",
                "alpha": 0.25,
                "eta": {"type": "rgb", "value": [0.2] * 3},
                "k": {"type": "rgb", "value": [3.0] * 3},
            }
        ),
    ),
    Twin(
        "dielectric",
        "ball of a rough dielectric (GGX), the same",
        _studio(DIELECTRIC),
        _studio_theirs(
            {"type": "roughdielectric", "distribution": "ggx", "alpha": 0.25, "int_ior": 1.5, "ext_ior": 1.0}
        ),
    ),
    Twin("glass", "dielectric ball, mirror ball, thin pane under a sky", _glass, _glass_theirs),
)
