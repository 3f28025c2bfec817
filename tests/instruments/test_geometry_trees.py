"""Tensor trees of parts that exist as geometry."""

import math
from pathlib import Path

import gonio
import numpy as np
import pytest

EXAMPLES = Path(__file__).parents[2] / "examples" / "geometry"
SLATS = {"window": (0, 0, 0.01, 0.01), "periodic": True}
RINGS = ((0, 9, 1), (9, 27, 8), (27, 45, 12), (45, 63, 12), (63, 90, 8))
"""Of the quarter basis: polar angles and patches."""

OTHER = {"front": "back", "back": "front"}

PLATE = """void plastic grey
0
0
5 .4 .4 .4 0 0
grey polygon plate
0
0
12 0 0 0 1 0 0 1 1 0 0 1 0
"""

GROOVE = """void mirror silver
0
0
3 .8 .8 .8
silver polygon down
0
0
12 -1 0 0 2 0 0 2 .5 -.5 -1 .5 -.5
silver polygon up
0
0
12 -1 .5 -.5 2 .5 -.5 2 1 0 -1 1 0
"""


def even(count, seed, *, side="front", most=90.0):
    """Directions even in projected solid angle up to a polar angle, degrees."""
    rng = np.random.default_rng(seed)
    theta = np.degrees(np.arcsin(math.sin(math.radians(most)) * np.sqrt(rng.random(count))))
    phi = rng.uniform(0, 360, count)
    return (theta if side == "front" else 180.0 - theta), phi


@pytest.fixture(scope="module")
def slats():
    """The example's slats as a tree and as matrices."""
    file = EXAMPLES / "slats.rad"
    tree = gonio.simulate_geometry(file, **SLATS, basis="ttree4", levels=4, rays=512)
    return tree, gonio.simulate_geometry(file, **SLATS, basis="quarter", rays=8192)


def test_a_grey_plate_becomes_few_cells_and_is_read_back(tmp_path):
    (tmp_path / "plate.rad").write_text(PLATE)
    found = gonio.simulate_geometry(tmp_path / "plate.rad", periodic=True, basis="ttree4", levels=3, rays=256)
    # Of 4096 cells of each side some stay by chance.
    assert found.cells < 2000
    ti, pi = even(400, 1)
    ts, ps = even(400, 2)
    f = found.model.eval(theta_i=ti, phi_i=pi, theta_s=ts, phi_s=ps)
    u = found.standard_error.eval(theta_i=ti, phi_i=pi, theta_s=ts, phi_s=ps)
    assert np.abs(f - 0.4 / math.pi).max() < 0.1 * 0.4 / math.pi
    # Cells stay apart where chance made them differ: those lie further off than their errors.
    assert np.mean(np.abs(f - 0.4 / math.pi) <= 2.0 * u) > 0.85
    # A cell alone is known to 35 % from 256 rays.
    assert found.relative_error["front", "reflection"] < 0.1
    found.write(tmp_path / "plate.xml", name="plate")
    read = gonio.read_bsdf(tmp_path / "plate.xml")
    assert np.array_equal(read.eval(theta_i=ti, phi_i=pi, theta_s=ts, phi_s=ps), f)


def test_a_groove_of_two_mirrors_returns_what_meets_both(tmp_path):
    # Of light of slope t <= 1 across the groove 1 - t meets both mirrors and comes back, t meets one.
    (tmp_path / "groove.rad").write_text(GROOVE)
    found = gonio.simulate_geometry(
        tmp_path / "groove.rad",
        window=(0, 0, 1, 1),
        periodic=True,
        basis="ttree4",
        levels=4,
        rays=1024,
        tolerance=0.0,
        sides=["front"],
    )
    ti, pi = even(3000, 3, most=40.0)
    slope = np.abs(np.tan(np.radians(ti)) * np.sin(np.radians(pi)))
    wanted = 0.64 * (1.0 - slope) + 0.8 * slope
    albedo = np.array([found.model.albedo(theta_i=t, phi_i=p) for t, p in zip(ti, pi, strict=True)])
    # The slope changes by up to .25 within a cell, the albedo by .04; both sides of the mean count alike.
    assert np.abs(albedo - wanted).max() < 0.06
    assert np.std(albedo - wanted) < 0.012
    assert albedo.mean() == pytest.approx(wanted.mean(), rel=0.003)
    # Light of a cell at the normal, of mean slope .053, that meets both goes to the next along the groove.
    cell = math.pi / 256
    f = found.model.eval(theta_i=2.0, phi_i=45.0, theta_s=[2.0] * 4, phi_s=[45.0, 135.0, 225.0, 315.0])
    assert f.sum() * cell == pytest.approx(0.64 * (1.0 - 0.053), rel=0.02)


def test_the_energy_of_each_incidence_is_that_of_the_matrices(slats):
    tree, klems = slats
    rng = np.random.default_rng(5)
    areas = [(np.diff(np.sin(np.radians([low, high])) ** 2)[0] / n, n) for low, high, n in RINGS]
    weights = np.concatenate([np.full(n, area) for area, n in areas])
    for side in ("front", "back"):
        for component in ("reflection", "transmission"):
            means = klems.means[side, component]
            first, off, sums = 0, [], np.zeros(2)
            for low, high, n in RINGS:
                s = np.sin(np.radians([low, high])) ** 2
                for k in range(n):
                    theta = np.degrees(np.arcsin(np.sqrt(s[0] + rng.random(400) * (s[1] - s[0]))))
                    # Incident patches are turned by 180 degrees.
                    phi = 360.0 * (k - 0.5 + rng.random(400)) / n + 180.0
                    theta = theta if side == "front" else 180.0 - theta
                    of_tree = np.mean(
                        [
                            tree.model.albedo(theta_i=t, phi_i=p % 360.0, component=component)
                            for t, p in zip(theta, phi, strict=True)
                        ]
                    )
                    column = math.pi * weights @ means.luminance[:, first + k]
                    error = math.pi * math.sqrt((weights**2) @ means.errors[:, first + k] ** 2)
                    off.append((of_tree - column) / math.hypot(error, 0.02 * column, 0.005))
                    sums += np.array([of_tree, column]) * (s[1] - s[0]) / n
                first += n
            # Albedos of cells are known to some percent, and do not end where patches do.
            assert np.sqrt(np.mean(np.square(off))) < 1.5, (side, component)
            # All light is known to .3 % from 131 thousand rays.
            assert sums[0] == pytest.approx(sums[1], rel=0.01), (side, component)


def test_errors_are_the_scatter_of_other_seeds(slats):
    # Against sixteen times the rays the deviations have the mean square that is stated.
    tree, _ = slats
    file = EXAMPLES / "slats.rad"
    finer = gonio.simulate_geometry(file, **SLATS, basis="ttree4", levels=4, rays=8192, seed=9, tolerance=0.0)
    for side in ("front", "back"):
        for component in ("reflection", "transmission"):
            ti, pi = even(20_000, 1, side=side)
            to = side if component == "reflection" else OTHER[side]
            ts, ps = even(20_000, 2, side=to)
            at = {"theta_i": ti, "phi_i": pi, "theta_s": ts, "phi_s": ps}
            f, g = tree.model.eval(**at), finer.model.eval(**at)
            rms = math.sqrt(np.mean((f - g) ** 2)) / g.mean()
            stated = tree.relative_error[side, component]
            assert 0.7 * stated < rms < 1.4 * stated, (side, component)


def test_values_are_reciprocal(slats):
    tree, _ = slats
    ti, pi = even(500, 3)
    ts, ps = even(500, 4, side="back")
    one = tree.model.eval(theta_i=ti, phi_i=pi, theta_s=ts, phi_s=ps)
    other = tree.model.eval(theta_i=ts, phi_i=ps, theta_s=ti, phi_s=pi)
    # Both components hold the same averages; sums in another order may merge other cells.
    assert np.mean(np.abs(one - other) <= 1e-3 * np.maximum(one, other)) > 0.99


def test_an_isotropic_part_becomes_a_tree_of_rank_3(tmp_path):
    (tmp_path / "plate.rad").write_text(PLATE.replace("5 .4 .4 .4 0 0", "5 .3 .3 .3 .1 .2"))
    found = gonio.simulate_geometry(
        tmp_path / "plate.rad", periodic=True, basis="ttree3", levels=5, rays=16384, sides=["front"]
    )
    assert found.model.rank == 3
    truth = gonio.read_bsdf(tmp_path / "plate.rad")
    for theta in (5.0, 40.0, 65.0):
        wanted = gonio.directional_albedo(truth, theta_i=theta, phi_i=70.0, channel="green")
        # 16384 rays of each incidence leave .8 %, the albedo changes by 1 % within a cell.
        assert found.model.albedo(theta_i=theta, phi_i=20.0) == pytest.approx(wanted, rel=0.03)


def test_trees_of_an_error(tmp_path):
    (tmp_path / "plate.rad").write_text(PLATE)
    found = gonio.simulate_geometry(
        tmp_path / "plate.rad", periodic=True, basis="ttree4", levels=3, error=0.02
    )
    assert max(found.relative_error.values()) <= 0.02
    assert found.rays > 64


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"basis": "ttree5"}, "basis: found ttree5, allowed full, half, quarter, ttree3, ttree4"),
        ({"levels": 7}, "levels: found 7, allowed 2 to 6"),
        ({"tolerance": -0.1}, "tolerance: found -0.1"),
        ({"max_cells": 3}, "max_cells: found 3"),
    ],
)
def test_what_is_no_tree_is_refused(tmp_path, arguments, words):
    (tmp_path / "plate.rad").write_text(PLATE)
    with pytest.raises(gonio.DomainError) as error:
        gonio.simulate_geometry(tmp_path / "plate.rad", **{"basis": "ttree4", **arguments})
    assert words in str(error.value)
