"""RADIANCE's interpolants, read and evaluated as RADIANCE evaluates them."""

import gonio
import numpy as np
import pytest
from gonio.model_files import summarise

LOBE = {"model": "ward-gmd-anisotropic", "rho": 0.3, "alpha_x": 0.2, "alpha_y": 0.2, "phi_x": 0.0}
BASE = {"model": "lambert", "rho": 0.3}
ISOTROPIC = gonio._native.analytic([BASE, LOBE])
ANISOTROPIC = gonio._native.analytic([BASE, LOBE | {"alpha_x": 0.15, "alpha_y": 0.3}])
ISOTROPIC_AT = [(t, 180.0) for t in (10.0, 25.0, 40.0, 55.0, 70.0)]
ANISOTROPIC_AT = [(0.0, 0.0)] + [(t, p) for t in (25.0, 50.0, 70.0) for p in (0.0, 45.0, 90.0)]


def scan(folder, model, incidences, n):
    """Mountain files of a scan over even directions, 85 degrees at most from the normal."""
    k = np.arange(n)
    z = 1 - (1 - np.cos(np.radians(85.0))) * (k + 0.5) / n
    theta, phi = np.degrees(np.arccos(z)), (k * 222.49223594996) % 360
    files = []
    for theta_i, phi_i in incidences:
        f = model.eval(theta_i=theta_i, phi_i=phi_i, theta_s=theta, phi_s=phi)
        path = folder / f"s_{theta_i:.0f}_{phi_i:.0f}.txt"
        head = f"#format: theta phi BSDF\n#incident_angle {theta_i} {phi_i}\n#upphi 90\n#colorimetry: CIE-Y\n"
        rows = np.stack([theta, phi, f], axis=-1)
        with path.open("w") as out:
            out.write(head)
            np.savetxt(out, rows, fmt="%.4f %.4f %.6g")
        files.append(path.name)
    return files


def converted(radiance, folder, model, incidences, n):
    files = scan(folder, model, incidences, n)
    (folder / "s.sir").write_bytes(radiance.run("pabopto2bsdf", *files, cwd=folder))
    return folder / "s.sir"


@pytest.fixture(scope="session")
def isotropic(radiance, tmp_path_factory):
    return converted(radiance, tmp_path_factory.mktemp("iso"), ISOTROPIC, ISOTROPIC_AT, 12_000)


@pytest.fixture(scope="session")
def anisotropic(radiance, tmp_path_factory):
    return converted(radiance, tmp_path_factory.mktemp("aniso"), ANISOTROPIC, ANISOTROPIC_AT, 2_500)


def radiances_own(radiance, sir, order):
    """What RADIANCE has at the centres of the cells of a tree, without averaging or joining them."""
    options = ("-t", "-1", "-s", "1e9", "-g", str(order))
    xml = sir.with_suffix(".xml")
    xml.write_bytes(radiance.run("bsdf2ttree", *options, sir.name, cwd=sir.parent))
    return gonio.read_radiance(xml)


def disk(u, v):
    """Direction cosines of points of the square [ShirleyChiu1997]."""
    a, b = 2 * u - 1, 2 * v - 1
    swap = np.abs(a) > np.abs(b)
    r, s = np.where(swap, a, b), np.where(swap, b, a)
    t = np.pi / 4 * s / np.where(r == 0, 1, r)
    return np.where(swap, r * np.cos(t), r * np.sin(t)), np.where(swap, r * np.sin(t), r * np.cos(t))


def angles(x, y):
    return {"theta": np.degrees(np.arcsin(np.hypot(x, y))), "phi": np.degrees(np.arctan2(y, x)) % 360}


def exits(n, most=75.0):
    """Centres of n x n cells, off the horizon."""
    u, v = np.meshgrid((np.arange(n) + 0.5) / n, (np.arange(n) + 0.5) / n)
    at = angles(*disk(u.ravel(), v.ravel()))
    inside = at["theta"] < most
    return at["theta"][inside], at["phi"][inside]


def both(model, tree, theta_i, phi_i, n):
    theta_s, phi_s = exits(n)
    at = {"theta_i": theta_i, "phi_i": phi_i, "theta_s": theta_s, "phi_s": phi_s}
    return model.eval(**at), tree.eval(**at)


def test_an_isotropic_interpolant_answers_as_radiance_does(radiance, isotropic):
    model = gonio.read_bsdf(isotropic)
    tree = radiances_own(radiance, isotropic, 7)
    assert model.properties["isotropic"]
    centres = np.degrees(np.arcsin(1 - (np.arange(64) + 0.5) / 64))
    found = []
    for theta_i in centres[(centres > 12.0) & (centres < 69.0)]:
        ours, theirs = both(model, tree, theta_i, 180.0, 128)
        found.append(np.sum(np.abs(ours - theirs)) / np.sum(theirs))
    # RADIANCE sets its incidences off by half a cell, which puts some lobes into the next cell of its grid
    assert len(found) > 40
    assert np.mean(found) < 0.009
    assert max(found) < 0.012


def test_an_anisotropic_interpolant_answers_as_radiance_does(radiance, anisotropic):
    model = gonio.read_bsdf(anisotropic)
    tree = radiances_own(radiance, anisotropic, 4)
    found = []
    centres = (np.arange(16) + 0.5) / 16
    for a in centres:
        for b in centres:
            x, y = disk(np.array(a), np.array(b))
            at = angles(-x, -y)
            if not 5.0 < at["theta"] < 68.0:
                continue
            ours, theirs = both(model, tree, float(at["theta"]), float(at["phi"]), 16)
            found.append(np.sum(np.abs(ours - theirs)) / np.sum(theirs))
    assert len(found) > 100
    assert np.median(found) < 5e-4
    assert np.quantile(found, 0.9) < 3e-3
    # beside an edge RADIANCE goes along that edge alone
    assert max(found) < 0.02


def test_an_interpolant_is_near_the_material_that_was_scanned(isotropic):
    model = gonio.read_bsdf(isotropic)
    found = gonio.compare(ISOTROPIC, model, components=[("front", "reflection")], incidences=[(40.0, 0.0)])
    assert found.rows[0].rel_l1 < 0.2
    assert found.rows[0].dhr_b == pytest.approx(found.rows[0].dhr_a, rel=0.05)


def test_an_interpolant_is_summed_up_exported_and_checked(isotropic, tmp_path):
    (part,) = summarise(isotropic).components
    assert (part.side, part.component, part.representation) == ("front", "reflection", "interpolant")
    assert part.resolution.startswith("isotropic, ")
    assert 0.3 < part.albedo_min <= part.albedo_max < 1.0
    model = gonio.read_bsdf(isotropic)
    assert model.channels == ["photopic"]
    gonio.export(isotropic, to="radiance-ttree", out=tmp_path / "t.xml", max_depth=5)
    assert gonio.read_radiance(tmp_path / "t.xml").rank == 3
    assert {v.id for v in gonio.check_model(model)} >= {"values", "energy", "reciprocity"}
    cut = tmp_path / "cut.sir"
    cut.write_bytes(isotropic.read_bytes()[:3000])
    with pytest.raises(gonio.FormatError, match=r"cut.sir: .*is the file cut short"):
        gonio.read_bsdf(cut)
