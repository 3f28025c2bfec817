"""Arrays of unit vectors in, arrays out: shapes, precision, layouts and what is refused."""

import gonio
import numpy as np
import pytest
from gonio import _native


def unit(n, seed=1):
    rng = np.random.default_rng(seed)
    v = rng.standard_normal((3, n))
    return v / np.linalg.norm(v, axis=0)


def degrees(v):
    return np.degrees(np.arctan2(np.hypot(v[0], v[1]), v[2])), np.degrees(np.arctan2(v[1], v[0]))


@pytest.fixture(scope="module")
def model():
    rho = {"red": 0.5, "green": 0.3, "blue": 0.1}
    return _native.analytic(
        [{"model": "lambert", "rho": rho}, {"model": "ward-gmd", "rho": 0.3, "alpha": 0.2}]
    )


def expected(model, wi, ws):
    (theta_i, phi_i), (theta_s, phi_s) = degrees(wi), degrees(ws)
    return np.stack(
        [
            model.eval(theta_i=theta_i, phi_i=phi_i, theta_s=theta_s, phi_s=phi_s, channel=c)
            for c in model.channels
        ]
    )


def test_unit_vectors_give_the_values_of_their_angles(model):
    wi, ws = unit(10_001), unit(10_001, 2)
    f = model.eval_directions(wi=wi, ws=ws)
    assert f.shape == (3, 10_001)
    assert f.dtype == np.float64
    want = expected(model, wi, ws)
    assert np.count_nonzero(want) > 10_000
    np.testing.assert_allclose(f, want, rtol=1e-10)


def test_single_precision_in_gives_single_precision_out(model):
    wi, ws = unit(10_001).astype(np.float32), unit(10_001, 2).astype(np.float32)
    f = model.eval_directions(wi=wi, ws=ws)
    assert f.dtype == np.float32
    np.testing.assert_allclose(f, model.eval_directions(wi=wi.astype(float), ws=ws.astype(float)), rtol=1e-5)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_layout_gives_the_same_values(model, dtype):
    wi, ws = unit(5001).astype(dtype), unit(5001, 2).astype(dtype)
    f = model.eval_directions(wi=wi, ws=ws)
    other = model.eval_directions(wi=np.ascontiguousarray(wi.T), ws=np.ascontiguousarray(ws.T))
    np.testing.assert_array_equal(other, f)
    apart = model.eval_directions(wi=np.asfortranarray(wi)[:, ::-2], ws=ws[:, ::-2])
    np.testing.assert_array_equal(apart, f[:, ::-2])
    one = model.eval_directions(wi=[float(c) for c in wi[:, 7]], ws=ws)
    same = model.eval_directions(wi=np.repeat(wi[:, 7:8], 5001, axis=1), ws=ws)
    np.testing.assert_allclose(one, same, rtol=1e-6 if dtype == np.float32 else 1e-13)
    swapped = model.eval_directions(wi=wi, ws=ws[:, 7])
    assert swapped.shape == (3, 5001)
    pair = model.eval_directions(wi=wi[:, 7], ws=ws[:, 7])
    assert pair.shape == (3, 1)
    np.testing.assert_allclose(pair[:, 0], f[:, 7], rtol=1e-6)


def test_samples_are_those_of_the_angles(model):
    u = np.random.default_rng(3).random((3, 5001))
    wi = np.array([np.sin(0.5), 0.0, np.cos(0.5)])
    got = model.sample_directions(wi=wi, u=u)
    want = model.sample(theta_i=np.degrees(0.5), phi_i=0, u=u.T)
    ok = want["weight"] > 0
    assert ok.sum() > 4000
    theta, phi = degrees(got["ws"][:, ok])
    np.testing.assert_allclose(theta, want["theta_s"][ok], atol=1e-9)
    np.testing.assert_allclose(phi % 360, want["phi_s"][ok], atol=1e-9)
    np.testing.assert_allclose(got["weight"][0], want["weight"], rtol=1e-9)
    np.testing.assert_allclose(got["pdf"], want["pdf"], rtol=1e-9)
    assert np.isnan(got["ws"][:, ~ok]).all()


def test_weights_of_samples_integrate_to_the_albedo_of_every_channel():
    rho = {"red": 0.5, "green": 0.3, "blue": 0.1}
    lobe = _native.analytic(
        [{"model": "ward-gmd-anisotropic", "rho": rho, "alpha_x": 0.1, "alpha_y": 0.2, "phi_x": 30}]
    )
    n = 200_000
    u = np.random.default_rng(4).random((n, 3)).astype(np.float32)
    drawn = lobe.sample_directions(wi=[0, 0, 1], u=u)
    assert drawn["weight"].dtype == drawn["ws"].dtype == drawn["pdf"].dtype == np.float32
    ws = unit(n, 5)
    ws[2] = abs(ws[2])
    f = lobe.eval_directions(wi=[0, 0, 1], ws=ws)
    uniform = (f * ws[2] * 2 * np.pi).mean(axis=1)
    # Weights vary little; the uniform estimate has a standard error below 1 %: five of them.
    np.testing.assert_allclose(drawn["weight"].mean(axis=1), uniform, rtol=0.05)


def test_empty_columns_give_empty_results(model):
    assert model.eval_directions(wi=[0, 0, 1], ws=np.empty((3, 0))).shape == (3, 0)
    assert model.sample_directions(wi=[0, 0, 1], u=np.empty((3, 0)))["ws"].shape == (3, 0)


@pytest.mark.parametrize(
    ("wi", "ws", "text"),
    [
        ([0, 0, 2], unit(5), "unit vector"),
        ([0, 0, 1], unit(5) * 1.01, "ws of pair 0"),
        ([0, 0, np.nan], unit(5), "unit vector"),
        (unit(4), unit(5), "as many as wi"),
        ([0, 1], unit(5), "shape"),
        ([0, 0, 1], np.zeros((2, 5)), "shape"),
        ([0, 0, 1], np.zeros((3, 5, 2)), "shape"),
    ],
)
def test_what_is_not_a_direction_is_refused(model, wi, ws, text):
    with pytest.raises(gonio.DomainError, match=text):
        model.eval_directions(wi=wi, ws=ws)


def test_a_bad_vector_far_in_is_named(model):
    ws = unit(20_000).astype(np.float32)
    ws[1, 12_345] += 0.1
    with pytest.raises(gonio.DomainError, match="ws of pair 12345"):
        model.eval_directions(wi=[0, 0, 1], ws=ws)


def test_values_are_written_to_the_array_given(model):
    wi, ws = unit(5001, 1).astype(np.float32), unit(5001, 2).astype(np.float32)
    wanted = model.eval_directions(wi=wi, ws=ws)
    held = np.full_like(wanted, np.nan)
    assert model.eval_directions(wi=wi, ws=ws, out=held) is held
    np.testing.assert_array_equal(held, wanted)
    wide = np.full(wanted.shape, np.nan)
    exact = model.eval_directions(wi=wi.astype(float), ws=ws.astype(float), out=wide)
    assert exact is wide
    np.testing.assert_allclose(wide, wanted, rtol=1e-5)


def test_an_array_that_cannot_take_the_values_is_refused(model):
    ws = np.zeros((3, 5), np.float32)
    ws[2] = 1
    right = model.eval_directions(wi=[0, 0, 1], ws=ws)
    locked = right.copy()
    locked.flags.writeable = False
    wide = np.zeros((2 * right.shape[0], 5), np.float32)
    for out, text in [
        (right.astype(float), "float64"),
        (right.tolist(), "list"),
        (right[:, :4].copy(), "shape"),
        (wide[::2], "strides"),
        (locked, "read-only"),
    ]:
        with pytest.raises(gonio.DomainError, match=f"out: found .*{text}"):
            model.eval_directions(wi=[0, 0, 1], ws=ws, out=out)
    one = gonio.analytic({"model": "lambert", "rho": {"red": 0.5, "green": 0.5, "blue": 0.5}})
    with pytest.raises(gonio.DomainError, match="shared with"):
        one.eval_directions(wi=[0, 0, 1], ws=ws, out=ws)


@pytest.mark.parametrize("bad", [1.0, -0.1, np.nan])
def test_numbers_outside_the_unit_interval_are_refused(model, bad):
    u = np.full((3, 9000), 0.5, np.float32)
    u[2, 8999] = bad
    with pytest.raises(gonio.DomainError, match=r"u.*\[0, 1\)"):
        model.sample_directions(wi=[0, 0, 1], u=u)
