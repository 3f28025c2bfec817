import gonio
import numpy as np
import pytest
from gonio.weights import hemisphere_integral, hemisphere_weights
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import SphericalVoronoi


def scattered(n, seed=0):
    random = np.random.default_rng(seed)
    return np.degrees(np.arccos(random.random(n))), 360 * random.random(n)


def vectors(theta, phi):
    t, p = np.radians(theta), np.radians(phi)
    return np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], 1)


def test_cells_equal_those_of_scipy_on_the_points_and_their_mirror_images():
    theta, phi = scattered(3000)
    front = vectors(theta, phi)
    both = np.concatenate([front, front * [1, 1, -1]])
    peer = SphericalVoronoi(both).calculate_areas()[: len(front)]
    w = hemisphere_weights(theta, phi, side="front")
    np.testing.assert_allclose(w.omega, peer, rtol=1e-7, atol=1e-13)
    assert np.degrees(np.sqrt(2 * peer / np.pi)).max() > np.median(w.reach) / 2


@given(st.lists(st.tuples(st.floats(90, 180), st.floats(-720, 720)), min_size=1, max_size=30))
def test_cells_of_any_directions_tile_the_back(points):
    theta, phi = np.array(points).T
    w = hemisphere_weights(theta, phi, side="back")
    assert w.omega.sum() == pytest.approx(2 * np.pi, abs=1e-9)
    assert w.omega_projected.sum() == pytest.approx(np.pi, abs=1e-9)


def test_a_lambertian_integrates_to_its_albedo():
    theta, phi = scattered(2000)
    dsf = 0.7 * np.cos(np.radians(theta)) / np.pi
    r = hemisphere_integral(theta, phi, dsf, side="front", incidence=(10, 0), u_dsf=0.01 * dsf)
    assert r.value == pytest.approx(0.7, rel=1e-6)
    assert 0 < r.u_noise < 0.01 * 0.7
    assert abs(r.measured_omega - 2 * np.pi) < 0.05


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: hemisphere_weights([100.0], [0.0], side="front"), "hemisphere"),
        (lambda: hemisphere_weights([10.0], [0.0], side="top"), "side"),
        (lambda: hemisphere_weights([10.0, np.nan], [0.0, 0.0], side="front"), "direction 2"),
        (lambda: hemisphere_weights([10.0], [0.0, 1.0], side="front"), "phi_s"),
        (lambda: hemisphere_weights([], [], side="front"), "at least 1"),
        (lambda: hemisphere_integral([10.0], [0.0], [np.nan], side="front"), "dsf"),
        (lambda: hemisphere_integral([10.0], [0.0], [1.0], side="front", reach=-1.0), "reach"),
    ],
)
def test_every_bad_argument_is_named(call, words):
    with pytest.raises(gonio.DomainError, match=words):
        call()
