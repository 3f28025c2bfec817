"""The XML gonio reads and writes means to RADIANCE what it means to gonio."""

from pathlib import Path

import gonio
import numpy as np
import pytest
from gonio import _native

from .radiance import FILES, MODELS, differences

# RADIANCE perturbs what it looks up on purpose: matrices by 3e-4, trees by 2e-4
PERTURBATION = 5e-4


@pytest.mark.parametrize("file", FILES)
def test_real_files_mean_the_same(radiance, shared, file):
    path = shared / file
    if not path.exists():
        pytest.skip(f"{file} is not on this machine")
    error, values = differences(radiance, path, _native.read_radiance_xml(path))
    assert len(values) > 500
    # directions within rounding of the edge of a cell may fall on either side of it
    assert np.quantile(error, 0.998) < PERTURBATION


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
@pytest.mark.parametrize("name", MODELS)
def test_written_matrices_mean_the_same(radiance, tmp_path, basis, name):
    model = _native.to_klems(_native.analytic(MODELS[name]), basis=basis)
    path = tmp_path / "a.xml"
    _native.write_radiance_xml(path, model, name=name)
    error, _ = differences(radiance, path, model)
    assert np.quantile(error, 0.998) < PERTURBATION


@pytest.mark.parametrize("rank", [3, 4])
@pytest.mark.parametrize("name", MODELS)
def test_written_trees_mean_the_same(radiance, tmp_path, rank, name):
    if (name, rank) == ("anisotropic", 3):
        with pytest.raises(_native.DomainError, match="rank"):
            _native.to_tensor_tree(_native.analytic(MODELS[name]), rank=3)
        return
    model = _native.to_tensor_tree(_native.analytic(MODELS[name]), rank=rank, max_cells=20_000)
    path = tmp_path / "a.xml"
    _native.write_radiance_xml(path, model, name=name)
    error, _ = differences(radiance, path, model)
    assert np.quantile(error, 0.998) < PERTURBATION


def test_one_component_leaves_the_others_dark(radiance, tmp_path):
    model = _native.to_klems(_native.analytic(MODELS["isotropic"]), components=[("back", "reflection")])
    path = tmp_path / "a.xml"
    _native.write_radiance_xml(path, model)
    handle = radiance.load(path)
    assert radiance.query(handle, 150, 0, 140, 90) == pytest.approx(0.3 / np.pi, rel=0.02)
    assert radiance.query(handle, 30, 0, 40, 90) == 0


@pytest.mark.parametrize("kind", ["klems", "tree"])
def test_rtrace_renders_the_model(radiance, tmp_path, kind):
    source = _native.analytic(MODELS["isotropic"])
    model = _native.to_klems(source) if kind == "klems" else _native.to_tensor_tree(source)
    _native.write_radiance_xml(tmp_path / "a.xml", model)
    theta_i, size, radiance_of_source = 40.0, 0.5, 1e6
    s, c = np.sin(np.radians(theta_i)), np.cos(np.radians(theta_i))
    (tmp_path / "a.rad").write_text(
        f"void light sun 0 0 3 {radiance_of_source} {radiance_of_source} {radiance_of_source}\n"
        f"sun source s 0 0 4 {s} 0 {c} {size}\n"
        "void BSDF m 6 0 a.xml 0 1 0 . 0 0\n"
        "m polygon p 0 0 12 -1 -1 0 1 -1 0 1 1 0 -1 1 0\n"
    )
    octree = radiance.run("oconv", "a.rad", cwd=tmp_path)
    (tmp_path / "a.oct").write_bytes(octree)
    solid_angle = 2 * np.pi * (1 - np.cos(np.radians(size / 2)))
    irradiance = radiance_of_source * solid_angle * c
    # centres of Klems patches: RADIANCE jitters both directions over about a patch or cell
    views = [(20, 157.5), (60, 195), (40, 180), (30, 0), (70, 90)]
    rays, least, most = [], [], []
    jitter = np.linspace(-1, 1, 9) * (8.0 if kind == "klems" else 1.0)
    for theta, phi in views:
        s, c = np.sin(np.radians(theta)), np.cos(np.radians(theta))
        d = np.array([s * np.cos(np.radians(phi)), s * np.sin(np.radians(phi)), c])
        rays.append(" ".join(map(str, np.concatenate([d, -d]))))
        # RADIANCE looks up with the eye as the incidence and jitters directions over about a patch or cell
        f = model.eval(theta_i=theta + jitter[:, None], phi_i=phi + jitter, theta_s=theta_i, phi_s=0.0)
        least.append(f.min() * irradiance)
        most.append(f.max() * irradiance)
    out = radiance.run(
        "rtrace",
        "-h",
        "-ab",
        "0",
        "-dj",
        "0",
        "-ss",
        "64",
        "a.oct",
        cwd=tmp_path,
        stdin="\n".join(rays).encode(),
    )
    got = np.array([[float(v) for v in line.split()] for line in out.decode().splitlines()])[:, 1]
    assert np.all(got >= 0.99 * np.array(least))
    assert np.all(got <= 1.01 * np.array(most))
    # far from the lobe jitter changes nothing
    np.testing.assert_allclose(got[3:], np.array(least)[3:], rtol=0.01)


@pytest.mark.parametrize("kind", ["klems", "tree"])
def test_rpict_shows_the_model(radiance, tmp_path, kind):
    """A picture of a sheet in the sun: every pixel looks from its own direction."""
    source = _native.analytic(MODELS["isotropic"])
    model = _native.to_klems(source) if kind == "klems" else _native.to_tensor_tree(source)
    _native.write_radiance_xml(tmp_path / "a.xml", model)
    theta_i, size, radiance_of_source, n = 40.0, 0.5, 1e6, 24
    s, c = np.sin(np.radians(theta_i)), np.cos(np.radians(theta_i))
    (tmp_path / "a.rad").write_text(
        f"void light sun 0 0 3 {radiance_of_source} {radiance_of_source} {radiance_of_source}\n"
        f"sun source s 0 0 4 {s} 0 {c} {size}\n"
        "void BSDF m 6 0 a.xml 0 1 0 . 0 0\n"
        "m polygon p 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0\n"
    )
    (tmp_path / "a.oct").write_bytes(radiance.run("oconv", "a.rad", cwd=tmp_path))
    # seen from where the mirror direction goes, so that the lobe is in the middle
    view = ["-vtv", "-vp", str(-3 * s), "0", str(3 * c), "-vd", str(s), "0", str(-c), "-vu", "0", "1", "0"]
    view += ["-vh", "60", "-vv", "60"]
    exact = ["-ab", "0", "-dj", "0", "-pj", "0", "-ps", "1", "-ss", "64"]
    picture = radiance.run("rpict", *view, *exact, "-x", str(n), "-y", str(n), "a.oct", cwd=tmp_path)
    text = radiance.run("pvalue", "-h", "-H", "-d", "-b", cwd=tmp_path, stdin=picture)
    got = np.array(text.split(), float).reshape(n, n)
    rays = radiance.run("vwrays", *view, "-x", str(n), "-y", str(n), cwd=tmp_path)
    direction = np.array(rays.split(), float).reshape(n, n, 6)[..., 3:]
    theta = np.degrees(np.arccos(-direction[..., 2]))
    phi = np.degrees(np.arctan2(-direction[..., 1], -direction[..., 0]))
    irradiance = radiance_of_source * 2 * np.pi * (1 - np.cos(np.radians(size / 2))) * c
    # RADIANCE jitters directions over about a patch or cell
    jitter = np.linspace(-1, 1, 9) * (8.0 if kind == "klems" else 2.0)
    near = {
        "theta_i": np.clip(theta[..., None, None] + jitter[:, None], 0, 90),
        "phi_i": phi[..., None, None] + jitter / np.sin(np.radians(theta.clip(10)))[..., None, None],
    }
    f = model.eval(theta_s=theta_i, phi_s=0.0, **near) * irradiance
    # a pixel has 8 bits a colour
    assert np.all(got >= 0.98 * f.min(axis=(2, 3))), (got / f.min(axis=(2, 3))).min()
    assert np.all(got <= 1.02 * f.max(axis=(2, 3))), (got / f.max(axis=(2, 3))).max()
    assert got.max() > 4 * np.median(got) / (2 if kind == "klems" else 1)
    np.testing.assert_allclose(got.sum(), f.mean(axis=(2, 3)).sum(), rtol=0.03)


def test_trees_of_geometry_mean_the_same(radiance, tmp_path):
    slats = Path(__file__).parents[2] / "examples" / "geometry" / "slats.rad"
    found = gonio.simulate_geometry(
        slats, window=(0, 0, 0.01, 0.01), periodic=True, basis="ttree4", levels=4, rays=64
    )
    path = tmp_path / "slats.xml"
    found.write(path, name="slats")
    error, values = differences(radiance, path, found.model)
    assert len(values) > 2000
    assert np.quantile(error, 0.998) < PERTURBATION
