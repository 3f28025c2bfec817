"""Exact spherical weights against scipy, and directions to integral at one million readings."""

import time

import numpy as np
from gonio.weights import hemisphere_integral, hemisphere_weights
from scipy.spatial import SphericalVoronoi

COMMAND = "python -m bench.weights"
IDS = ["weights-vs-scipy", "weights-vs-scipy-mirrored", "integral-1m"]
LIMIT_1M = 4.0
"""CPU seconds allowed for one million readings from directions to DHR."""


def _cpu(work, repeats: int = 3) -> float:
    """Smallest CPU seconds of a few calls."""
    seconds = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        seconds.append(time.process_time() - start)
    return min(seconds)


def scattered(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Directions of the front at random, uniform in solid angle, degrees."""
    random = np.random.default_rng(seed)
    return np.degrees(np.arccos(1 - random.random(n) * 0.9999)), 360 * random.random(n)


def rings(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """About `n` readings along rings of 0.5 degrees in the order of a path, jittered, degrees."""
    random = np.random.default_rng(seed)
    theta = np.arange(0.25, 89.0, 0.5)
    share = np.sin(np.radians(theta))
    counts = np.maximum(8, np.round(n * share / share.sum()).astype(int))
    t = np.repeat(theta, counts) + 0.02 * random.standard_normal(counts.sum())
    p = np.concatenate([(np.arange(c) + random.random()) * 360 / c for c in counts])
    return np.clip(t, 0, 89.4), p


def vectors(theta: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Unit vectors of degrees, one a row."""
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], 1)


def run() -> list[dict]:
    """Records of this module.

    `weights-vs-scipy`: 100,000 directions of the front, scipy given the same directions (its cells are not
    clipped at the horizon and reach to the back). `weights-vs-scipy-mirrored`: scipy given directions and
    mirror images, which gives the same areas as ours (checked here). `integral-1m`: one million readings from
    arrays of degrees to DHR.
    """
    n = 100_000
    theta, phi = scattered(n)
    front = vectors(theta, phi)
    both = np.concatenate([front, front * [1, 1, -1]])
    w = hemisphere_weights(theta, phi, side="front")
    ours = _cpu(lambda: hemisphere_weights(theta, phi, side="front"))
    records = []
    for name, points in (("weights-vs-scipy", front), ("weights-vs-scipy-mirrored", both)):
        areas = np.empty(0)

        def peer(points: np.ndarray = points) -> None:
            nonlocal areas
            areas = SphericalVoronoi(points).calculate_areas()

        seconds = _cpu(peer, 1)
        records.append(
            {
                "id": name,
                "ours": ours,
                "peer": seconds,
                "peer_name": "scipy.spatial.SphericalVoronoi.calculate_areas",
                "ratio": seconds / ours,
                "unit": "CPU s",
                "command": COMMAND,
            }
        )
    worst = np.abs(w.omega - areas[:n]).max() / w.omega.mean()
    if worst > 1e-6:
        raise AssertionError(f"areas differ from scipy's by {worst:.1e} of the mean cell")
    theta, phi = rings(1_000_000)
    dsf = np.cos(np.radians(theta)) * (0.1 + np.exp(-(((theta - 30) / 10) ** 2)))
    u = 0.01 * dsf
    seconds = _cpu(
        lambda: hemisphere_integral(theta, phi, dsf, side="front", incidence=(30, 180), u_dsf=u), 1
    )
    records.append(
        {
            "id": "integral-1m",
            "ours": seconds,
            "peer": LIMIT_1M,
            "peer_name": "the project's own limit",
            "ratio": LIMIT_1M / seconds,
            "unit": "CPU s",
            "command": COMMAND,
        }
    )
    return records


if __name__ == "__main__":
    for record in run():
        print(record)
