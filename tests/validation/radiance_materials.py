"""Radiance materials of random parameters, evaluated by RADIANCE itself and by gonio.

One scene holds every material on a small patch of its own. The patches are turned at random, so that one
distant source lights each from another direction of its own frame; they lie side by side as seen from it
and shade nothing. Each is looked at from one direction. rtrace gives the radiance of all of them in one
run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from gonio import RadianceMaterial
from numpy.typing import NDArray

if TYPE_CHECKING:
    from .radiance import Radiance

Vectors = NDArray[np.float64]
CHANNELS = ("red", "green", "blue")
RELEASE = "6.0"
"""Release of the programs in the wheel."""

DIRECT = ["-ab", "0", "-dj", "0", "-ds", "0", "-dt", "0", "-dc", "1", "-st", "1"]
"""Options of rtrace that leave the direct calculation alone, without jitter and without specular samples."""

IRRADIANCE = 1e4


def _orientation(rng: np.random.Generator) -> Vectors:
    """A vector u that does not stand on the surface."""
    u = rng.normal(size=3)
    u[:2] += np.sign(u[:2]) * 0.1
    return u


def _shares(rng: np.random.Generator, *names: str) -> dict[str, float]:
    return dict(zip(names, rng.uniform(0.05, 0.95, len(names)), strict=True))


def _rough(rng: np.random.Generator) -> float:
    return float(np.exp(rng.uniform(np.log(0.02), np.log(0.6))))


RGB = ("red", "green", "blue")
TRANSMITS = ("trans", "tspec")

ROUGH: Mapping[str, Callable[[np.random.Generator], dict[str, float]]] = {
    "plastic": lambda r: _shares(r, *RGB, "spec") | {"rough": _rough(r)},
    "metal": lambda r: _shares(r, *RGB, "spec") | {"rough": _rough(r)},
    "trans": lambda r: _shares(r, *RGB, "spec", *TRANSMITS) | {"rough": _rough(r)},
    "plastic2": lambda r: _shares(r, *RGB, "spec") | {"urough": _rough(r), "vrough": _rough(r)},
    "metal2": lambda r: _shares(r, *RGB, "spec") | {"urough": _rough(r), "vrough": _rough(r)},
    "trans2": lambda r: _shares(r, *RGB, "spec", *TRANSMITS) | {"urough": _rough(r), "vrough": _rough(r)},
    "ashik2": lambda r: (
        _shares(r, "dred", "dgreen", "dblue", "sred", "sgreen", "sblue")
        | {name: float(np.exp(r.uniform(0.0, np.log(5000.0)))) for name in ("upower", "vpower")}
    ),
}
"""Random parameters of the types that have lobes."""


def _smooth(spec: float) -> Callable[[np.random.Generator], dict[str, float]]:
    return lambda r: {"spec": float(r.uniform(0.0, spec)), "rough": 0.0}


SMOOTH: Mapping[str, Callable[[np.random.Generator], dict[str, float]]] = {
    "plastic": lambda r: _shares(r, *RGB) | _smooth(0.2)(r),
    "metal": lambda r: _shares(r, *RGB) | _smooth(0.95)(r),
    "trans": lambda r: _shares(r, *RGB, *TRANSMITS) | _smooth(0.2)(r),
    "glass": lambda r: _shares(r, "rtn", "gtn", "btn") | {"n": float(r.uniform(1.1, 2.5))},
    "mirror": lambda r: _shares(r, *RGB),
    "dielectric": lambda r: (
        {
            "rtn": 1.0,
            "gtn": 1.0,
            "btn": 1.0,
            "n": float(r.uniform(1.1, 2.5)),
            "hc": float(r.uniform(-20.0, 20.0)),
        }
    ),
}
"""Random parameters of the types that have ideal parts."""


def material(
    kind: str, parameters: Mapping[str, float], *, name: str, u: Vectors | None = None
) -> RadianceMaterial:
    """One material; u orients the anisotropic types."""
    strings = None if u is None else [*(repr(float(c)) for c in u), "."]
    return RadianceMaterial(kind, id=name, strings=strings, **parameters)


def rotations(rng: np.random.Generator, n: int) -> NDArray[np.float64]:
    """n frames (rows x, y, normal) of even distribution."""
    frames = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    frames[np.linalg.det(frames) < 0, 1] *= -1.0
    return frames


def degrees(v: Vectors) -> tuple[Vectors, Vectors]:
    """theta and phi of directions in degrees."""
    theta = np.degrees(np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2]))
    return theta, np.degrees(np.arctan2(v[:, 1], v[:, 0])) % 360.0


@dataclass(frozen=True)
class Case:
    """Materials of one type with their parameters, the directions in the frame of each, and that frame."""

    kind: str
    parameters: list[dict[str, float]]
    u: Vectors
    frames: NDArray[np.float64]
    wi: Vectors
    ws: Vectors

    @property
    def oriented(self) -> bool:
        return self.kind.endswith("2")

    @property
    def transmitted(self) -> NDArray[np.bool_]:
        return self.wi[:, 2] * self.ws[:, 2] < 0


def width(parameters: Mapping[str, float]) -> float:
    """A width of the lobes, to place directions by."""
    if "upower" in parameters:
        return float(np.sqrt(2.0 / min(parameters["upower"], parameters["vpower"])))
    return max(parameters.get(name, 0.0) for name in ("rough", "urough", "vrough"))


def draw(kind: str, make: Callable[[np.random.Generator], dict[str, float]], n: int, seed: int) -> Case:
    """n random materials and pairs of directions, half of them near the axis of a lobe, the others anywhere.

    The source stands on the world's z axis: the third column of a frame is its direction in that frame.
    """
    rng = np.random.default_rng(seed)
    frames = rotations(rng, 4 * n)
    frames = frames[np.abs(frames[:, 2, 2]) > np.cos(np.radians(86.0))][:n]
    wi = frames[:, :, 2]
    parameters = [make(rng) for _ in range(n)]
    transmits = kind.startswith("trans")
    z = rng.uniform(np.cos(np.radians(86.0)), 1.0, n)
    phi = rng.uniform(0.0, 2.0 * np.pi, n)
    r = np.sqrt(1.0 - z * z)
    ws = np.stack([r * np.cos(phi), r * np.sin(phi), z * np.sign(wi[:, 2])], -1)
    if transmits:
        ws[rng.random(n) < 0.5, 2] *= -1.0
    ideal = np.where(ws[:, 2:] * wi[:, 2:] > 0, wi * [-1.0, -1.0, 1.0], -wi)
    near = ideal + rng.normal(size=(n, 3)) * np.array([[width(p)] for p in parameters])
    near /= np.linalg.norm(near, axis=1)[:, None]
    wide = np.array([width(p) > 0 for p in parameters])
    keep = wide & (np.abs(near[:, 2]) > 0.07) & (near[:, 2] * ws[:, 2] > 0) & (rng.random(n) < 0.5)
    ws = np.where(keep[:, None], near, ws)
    u = np.array([_orientation(rng) for _ in range(n)])
    return Case(kind, parameters, u, frames, wi, ws)


def polygon(name: str, centre: Vectors, frame: Vectors, half: float) -> str:
    corners = [centre + half * (a * frame[0] + b * frame[1]) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    numbers = " ".join(repr(float(c)) for corner in corners for c in corner)
    return f"{name} polygon patch_{name} 0 0 12 {numbers}\n"


def solid_angle(source: float) -> float:
    """Solid angle of a disc of `source` degrees across, as RADIANCE reckons it."""
    return float(2.0 * np.pi * (1.0 - np.cos(np.radians(source / 2.0))))


def trace(radiance: Radiance, folder: Path, scene: str, rays: Vectors, options: list[str]) -> Vectors:
    """Radiance (rows of red, green, blue) of rays (rows of origin and direction)."""
    (folder / "scene.rad").write_text(scene, encoding="ascii")
    (folder / "scene.oct").write_bytes(radiance.run("oconv", "scene.rad", cwd=folder))
    command = ["rtrace", "-h", "-fdd", *options, "scene.oct"]
    out = radiance.run(*command, cwd=folder, stdin=np.ascontiguousarray(rays, dtype="<f8").tobytes())
    return np.frombuffer(out, dtype="<f8").reshape(-1, 3)


def of_radiance(radiance: Radiance, folder: Path, case: Case, source: float) -> Vectors:
    """f (1/sr) of every pair and channel by rtrace, under a distant source of `source` degrees across."""
    n = len(case.parameters)
    omega = solid_angle(source)
    level = IRRADIANCE / omega
    scene = [
        f"void light sun 0 0 3 {level!r} {level!r} {level!r}\n",
        f"sun source sky 0 0 4 0 0 1 {source!r}\n",
    ]
    side = int(np.ceil(np.sqrt(n)))
    k = np.arange(n)
    # Far apart, so that what a smooth patch mirrors is the dark.
    centres = np.stack([k % side, k // side, np.zeros(n)], -1) * 1000.0
    for j, parameters in enumerate(case.parameters):
        frame = case.frames[j]
        u = case.u[j] @ frame if case.oriented else None
        scene.append(material(case.kind, parameters, name=f"m{j}", u=u).text)
        scene.append(polygon(f"m{j}", centres[j], frame, 0.1))
    eye = np.einsum("nk,nkx->nx", case.ws, case.frames)
    found = trace(radiance, folder, "".join(scene), np.concatenate([centres + 0.3 * eye, -eye], 1), DIRECT)
    return found / (IRRADIANCE * np.abs(case.wi[:, 2:]))


def widened(parameters: Mapping[str, float], *, by: float) -> dict[str, float]:
    """The parameters with the squared roughness larger by `by`."""
    return {k: float(np.sqrt(v * v + by)) if k.endswith("rough") else v for k, v in parameters.items()}


def of_gonio(case: Case, source: float) -> Vectors:
    """f (1/sr) of every pair and channel by gonio.

    A source of solid angle omega widens RADIANCE's reflected lobes by omega / 4 pi and its transmitted ones
    by omega / pi, both added to the squared roughness; the material evaluated here has that much more of it.
    """
    omega = solid_angle(source)
    (theta_i, phi_i), (theta_s, phi_s) = degrees(case.wi), degrees(case.ws)
    f = np.empty((len(case.parameters), 3))
    for j, (parameters, through) in enumerate(zip(case.parameters, case.transmitted, strict=True)):
        wide = widened(parameters, by=omega / np.pi if through else omega / (4.0 * np.pi))
        if parameters.get("rough") == 0.0:
            wide = dict(parameters)
        made = material(case.kind, wide, name="m", u=case.u[j] if case.oriented else None)
        model = made.bsdf(release=RELEASE)
        for k, channel in enumerate(CHANNELS):
            f[j, k] = model.eval(
                theta_i=theta_i[j], phi_i=phi_i[j], theta_s=theta_s[j], phi_s=phi_s[j], channel=channel
            )
    return f


CUT = 1e-6
"""RADIANCE leaves out a lobe where its value (1/sr, of a lobe of share 1) is below this."""


@dataclass(frozen=True)
class Comparison:
    """f of gonio and RADIANCE for every pair and channel."""

    ours: Vectors
    theirs: Vectors

    @property
    def lit(self) -> NDArray[np.bool_]:
        """Where the material scatters."""
        return (self.ours > 0) | (self.theirs > 0)

    @property
    def cut(self) -> NDArray[np.bool_]:
        """Where RADIANCE has less, by no more than a lobe it leaves out, and by more than its rounding."""
        less = self.ours - self.theirs
        return (less > 1e-6 * self.ours) & (less <= CUT)

    @property
    def left_out(self) -> Vectors:
        """Relative differences where RADIANCE leaves a lobe out."""
        return 1.0 - self.theirs[self.cut] / self.ours[self.cut]

    @property
    def relative(self) -> Vectors:
        """Relative differences where the material scatters and RADIANCE leaves nothing out."""
        use = self.lit & ~self.cut
        return np.abs(self.ours[use] / self.theirs[use] - 1.0)


def compare(radiance: Radiance, folder: Path, case: Case, source: float) -> Comparison:
    """A case evaluated by both."""
    return Comparison(of_gonio(case, source), of_radiance(radiance, folder, case, source))


@dataclass(frozen=True)
class IdealComparison:
    """Share of the radiance that goes without spreading, by component, for every material, and by channel."""

    ours: dict[str, Vectors]
    theirs: dict[str, Vectors]


def compare_ideal(radiance: Radiance, folder: Path, kind: str, n: int, seed: int) -> IdealComparison:
    """Ideal parts of n random materials, each looked at from one direction.

    The patches lie in the xy-plane under a sky that glows above or below it, and nowhere else; glow is no
    light source, so what is seen of it has come straight through or off a patch. The share of radiance that
    a refraction passes is that of the flux times the squared ratio of the indices.
    """
    rng = np.random.default_rng(seed)
    parameters = [SMOOTH[kind](rng) for _ in range(n)]
    z = rng.uniform(0.05, 1.0, n) * np.where(rng.random(n) < 0.5, -1.0, 1.0)
    phi = rng.uniform(0.0, 2.0 * np.pi, n)
    eye = np.stack([np.sqrt(1.0 - z * z) * np.cos(phi), np.sqrt(1.0 - z * z) * np.sin(phi), z], -1)
    materials = [material(kind, p, name=f"m{j}") for j, p in enumerate(parameters)]

    centres = np.stack([10.0 * np.arange(n), np.zeros(n), np.zeros(n)], -1)
    patches = "".join(
        m.text + polygon(m.id, c, np.eye(3), 0.1) for m, c in zip(materials, centres, strict=True)
    )
    rays = np.concatenate([centres + 0.3 * eye, -eye], 1)
    seen = {}
    for name, up in (("above", 1), ("below", -1)):
        sky = f"void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 {up} 180\n"
        options = ["-ab", "0", "-lr", "2", "-lw", "1e-12"]
        seen[name] = trace(radiance, folder, sky + patches, rays, options)
    front = (z > 0)[:, None]
    theirs = {
        "reflection": np.where(front, seen["above"], seen["below"]),
        "transmission": np.where(front, seen["below"], seen["above"]),
    }
    theta, phi = degrees(eye)
    ours = {c: np.zeros((n, 3)) for c in theirs}
    for j, m in enumerate(materials):
        model = m.bsdf(release=RELEASE)
        for component, values in ours.items():
            for k, channel in enumerate(CHANNELS):
                part = model.delta(theta_i=theta[j], phi_i=phi[j], component=component, channel=channel)
                values[j, k] = part["share"]
                if kind == "dielectric" and component == "transmission":
                    index = m.parameters["n"] + m.parameters["hc"] / 500.0
                    values[j, k] *= index**2 if z[j] < 0 else index**-2
    return IdealComparison(ours, theirs)


SQUARE = "polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"


def sampled_albedo(
    radiance: Radiance, folder: Path, text: str, theta: float, *, jitter: int, rays: int = 20_000
) -> float:
    """Share of an even sky's radiance that RADIANCE's specular samples bring back from material m, red."""
    sky = "void glow sky 0 0 4 1 1 1 0\nsky source dome 0 0 4 0 0 1 360\n"
    scene = f"{sky}{text}\nm {SQUARE}"
    t = np.radians(theta)
    eye = np.array([np.sin(t), 0.0, np.cos(t)])
    ray = np.concatenate([0.1 * eye, -eye])
    options = ["-ab", "0", "-st", "0", "-ss", str(jitter), "-u+", "-lr", "2", "-lw", "1e-12"]
    return float(trace(radiance, folder, scene, np.tile(ray, (rays, 1)), options)[:, 0].mean())
