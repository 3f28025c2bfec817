import json

import gonio
import numpy as np
import pyarrow.csv
import pyarrow.parquet as pq
import pytest
from gonio import _native

from tests.cli.conftest import listing, one_clear_error
from tests.cli.test_build import lambertian


@pytest.fixture
def measured(tmp_path):
    gonio.process([lambertian(t) for t in (0, 20, 40, 60, 80)], out=tmp_path / "m")
    return tmp_path / "m"


@pytest.mark.parametrize("to", ["radiance-klems", "radiance-ttree"])
def test_a_radiance_file_holds_the_constant_it_was_made_from(run, measured, tmp_path, to):
    done = run("export", measured, "--to", to, "-o", "out.xml", "--json")
    assert done.code == 0, done.err
    found = json.loads(done.out)
    assert found["report"]["max_albedo"] == pytest.approx(0.5, rel=2e-3)
    loss = found["report"]["loss"]["front-reflection"]
    assert loss["rel_l1"] <= loss["rel_l1_max"] < 2e-3
    assert abs(loss["dhr_difference"]) < 1e-3
    model = gonio.read_radiance(tmp_path / "out.xml")
    f = model.eval(theta_i=[10.0, 50.0], phi_i=0.0, theta_s=30.0, phi_s=[120.0, 200.0])
    np.testing.assert_allclose(f, 0.5 / np.pi, rtol=2e-3)
    assert listing(tmp_path) == ["m", "out.xml"]


def test_the_loss_of_a_narrow_lobe_is_told_and_shrinks_with_finer_patches(run, tmp_path):
    lobe = {"model": "ward-gmd-anisotropic", "rho": 0.5, "alpha_x": 0.1, "alpha_y": 0.1, "phi_x": 0.0}
    model = _native.analytic([lobe])
    # midpoints of equal projected solid angle
    theta_s = np.degrees(np.arcsin(np.sqrt((np.arange(300) + 0.5) / 300)))[:, None]
    pairs = {"theta_i": 45.0, "phi_i": 0.0, "theta_s": theta_s, "phi_s": np.arange(0.5, 360)}
    losses = []
    for basis in ("quarter", "half", "full"):
        written = gonio.export(model, to="radiance-klems", basis=basis, out=tmp_path / f"{basis}.xml")
        loss = written.report["loss"]["front", "reflection"]
        reduced = gonio.read_radiance(tmp_path / f"{basis}.xml")
        f, g = model.eval(**pairs), reduced.eval(**pairs)
        assert abs(np.mean(g - f)) * np.pi <= abs(loss["dhr_difference"]) + 1e-3
        assert np.sum(abs(g - f)) / np.sum(f) <= loss["rel_l1_max"] + 1e-3
        losses.append(loss["rel_l1"])
    assert losses[0] > losses[1] > losses[2] > 0.2


def test_loss_and_albedo_are_printed(run, measured):
    done = run("export", measured, "--to", "radiance-klems", "--basis", "quarter", "-o", "out.xml")
    assert "largest directional albedo 0.5" in done.out
    assert "front reflection: differs from the full model by 0.0" in done.out
    assert "DHR by at most" in done.out


def test_a_single_wavelength_is_rendered_only_as_visible(run, tmp_path):
    gonio.process([lambertian(t, channel="532nm") for t in (10, 50)], out=tmp_path / "green")
    options = ["--to", "radiance-klems", "--basis", "quarter", "-o", "out.xml"]
    assert run("export", tmp_path / "green", *options, "--as-visible").code == 0
    model = gonio.read_radiance(tmp_path / "out.xml")
    assert model.channels == ["photopic"]


def test_a_single_wavelength_that_is_not_rendered_is_told(run, tmp_path):
    gonio.process([lambertian(t, channel="532nm") for t in (10, 50)], out=tmp_path / "green")
    for to in ("radiance-klems", "radiance-ttree"):
        options = ["--to", to, "--max-depth", "3", "-o", "out.xml"]
        done = run("export", tmp_path / "green", *options)
        assert done.code == 0
        assert "labelled 532nm" in done.err
        assert "--as-visible" in done.err
        assert "labelled" not in run("export", tmp_path / "green", *options, "--as-visible").err


def test_a_component_that_was_not_measured_is_an_error(run, measured, tmp_path):
    for to in ("radiance-klems", "radiance-ttree"):
        options = ["--to", to, "--component", "back-transmission", "-o", "out.xml"]
        one_clear_error(
            run("export", measured, *options), "back-transmission", "needed one of front-reflection"
        )
    assert listing(tmp_path) == ["m"]


def test_export_takes_the_interpolation_and_smoothing_of_build(run, measured, tmp_path):
    scans = [lobed(t) for t in (10, 30, 50, 70)]
    gonio.process(scans, out=tmp_path / "lobed")
    albedo = {}
    for candidate in ("naive", "base + half-vector"):
        options = ["--to", "radiance-klems", "--no-smooth", "--candidate", candidate, "-o", "out.xml"]
        assert run("export", tmp_path / "lobed", *options).code == 0
        model = gonio.build(tmp_path / "lobed", smooth=False, candidate=candidate)
        gonio.export(model, to="radiance-klems", out=tmp_path / "direct.xml")
        written = [gonio.read_radiance(tmp_path / f) for f in ("out.xml", "direct.xml")]
        matrices = [m.matrix() for m in written]
        np.testing.assert_array_equal(*matrices)
        albedo[candidate] = matrices[0]
    assert not np.allclose(albedo["naive"], albedo["base + half-vector"], rtol=1e-3)


def lobed(theta_i):
    """A diffuse base with a wide lobe about the mirror direction."""
    flat = lambertian(theta_i)
    theta_s, phi_s = np.radians(flat.theta_s), np.radians(flat.phi_s)
    x = np.sin(theta_s) * np.cos(phi_s) + np.sin(np.radians(theta_i))
    y = np.sin(theta_s) * np.sin(phi_s)
    return gonio.Scan(
        quantity="bsdf",
        theta_i=theta_i,
        phi_i=0,
        theta_s=flat.theta_s,
        phi_s=flat.phi_s,
        value=0.05 + 0.3 * np.exp(-(x**2 + y**2) / 0.15),
        meta={"noise_readout": 1e-5},
    )


def test_tables_hold_every_reading(run, measured, tmp_path):
    table = gonio.Measurement.load(measured).to_table()
    assert run("export", measured, "--to", "csv", "-o", "m.csv").code == 0
    assert run("export", measured, "--to", "parquet", "-o", "m.parquet").code == 0
    assert run("export", measured, "--to", "netcdf", "-o", "m.nc").code == 0
    csv = pyarrow.csv.read_csv(tmp_path / "m.csv")
    assert csv.column_names == table.column_names
    np.testing.assert_array_equal(csv["dsf"], table["dsf"])
    assert pq.read_table(tmp_path / "m.parquet").equals(table)


def test_mountain_text_reads_back_as_the_dsf_of_each_slice(run, measured, tmp_path):
    assert run("export", measured, "--to", "mountain", "-o", "mountain").code == 0
    files = sorted((tmp_path / "mountain").glob("slice_*.txt"))
    original = gonio.Measurement.load(measured)
    for file, s in zip(files, original.slices, strict=True):
        (scan,) = gonio.read(file)
        assert (scan.quantity, scan.theta_i) == ("dsf", pytest.approx(s.theta_i, abs=1e-6))
        np.testing.assert_allclose(scan.theta_s, s.theta_s, atol=1e-6)
        np.testing.assert_allclose(scan.value, s.dsf, rtol=1e-6)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (["--to", "word"], "word"),
        (["--to", "radiance-klems", "--basis", "tiny"], "tiny"),
        (["--to", "radiance-ttree", "--rank", "5"], "5"),
        (["--to", "radiance-klems", "--component", "front-absorption"], "absorption"),
        (["--to", "csv", "--channel", "red"], "red"),
    ],
)
def test_an_option_out_of_range_is_named_and_nothing_is_written(run, measured, tmp_path, options, name):
    one_clear_error(run("export", measured, *options, "-o", "out"), name)
    assert listing(tmp_path) == ["m"]


def test_a_model_is_no_table(tmp_path):
    scans = [lambertian(t) for t in (10, 50)]
    model = gonio.build(gonio.process(scans))
    with pytest.raises(gonio.QuantityError, match="model"):
        gonio.export(model, to="csv", out=tmp_path / "m.csv")


def test_a_directory_in_place_of_the_file_is_one_clear_error(run, measured, tmp_path):
    (tmp_path / "folder").mkdir()
    for to in ("csv", "radiance-klems"):
        one_clear_error(run("export", measured, "--to", to, "-o", "folder"), "folder", "directory")
