"""`gonio sphere` and `gonio fit --sphere`."""

import json

import pytest


def test_the_spheres_that_come_with_gonio_are_listed(run):
    result = run("sphere", "--list-spheres")
    assert result.code == 0
    assert "reflectance-300" in result.out
    assert "transmittance-500" in result.out


def test_a_sphere_states_total_specularity_and_the_cone(run, tmp_path):
    result = run("sphere", "plastic", "--rays", "4096", "--plot", tmp_path / "sphere.png")
    assert result.code == 0, result.err
    for word in ("total", "diffuse (trap open)", "specularity", "cone of the trap", "substitution error"):
        assert word in result.out
    assert (tmp_path / "sphere.png").read_bytes().startswith(b"\x89PNG")


def test_what_a_sphere_reads_is_fitted_with_a_known_roughness(run, tmp_path):
    readings, fitted = tmp_path / "readings.toml", tmp_path / "fit"
    result = run("sphere", "plastic", "--rays", "65536", "-o", readings, "--json")
    assert result.code == 0, result.err
    found = json.loads(result.out)
    assert found["half_angle"] == pytest.approx(3.37, abs=0.01)
    result = run(
        "fit", "--sphere", readings, "--model", "plastic", "--fix", "alpha=0.15", "-o", fitted, "--json"
    )
    assert result.code == 0, result.err
    fit = json.loads(result.out)
    assert [s["part"] for s in fit["sphere"]] == ["total", "diffuse"]
    assert (fitted / "material.rad").is_file()
    assert (fitted / "fit.json").is_file()


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        (("sphere",), "SAMPLE"),
        (("sphere", "plastic", "--sphere", "nothing"), "allowed a file, or one of"),
        (("sphere", "plastic", "--method", "guess"), "substitution, auxiliary, comparison"),
        (("sphere", "plastic", "--theta-i", "88"), "theta_i: found 88"),
        (("sphere", "plastic", "--error", "0"), "error: found 0"),
        (("sphere", "plastic", "--plot", "sphere.doc"), ".png, .svg, .pdf"),
        (("fit",), "a measurement, or --sphere"),
    ],
)
def test_wrong_use_is_one_line(run, arguments, wanted):
    result = run(*arguments)
    assert result.code == 2
    assert wanted in result.err
    assert len(result.err.strip().splitlines()) == 1


def test_a_sphere_alone_needs_a_model(run, tmp_path):
    readings = tmp_path / "readings.toml"
    readings.write_text('format = "gonio-sphere-readings 1"\n[[reading]]\ntotal = 0.5\nu_total = 0.01\n')
    result = run("fit", "--sphere", readings)
    assert result.code == 2
    assert "allowed one model" in result.err
    result = run("fit", "--sphere", readings, "--model", "plastic")
    assert result.code == 2
    assert "hold parameters" in result.err
