"""`gonio specularity`, `gonio roughness`, `gonio colour`."""

import json

import numpy as np
import pytest

from tests.cli.conftest import listing, one_clear_error

SPHERE = ("specularity", "--total", 0.55, "--diffuse", 0.5, "--port", 5)


@pytest.fixture
def spectrum(tmp_path):
    path = tmp_path / "s.csv"
    path.write_text("nm,SCI,SCE\n" + "".join(f"{w},0.5,0.4\n" for w in range(380, 781, 10)))
    return path


@pytest.fixture
def profile(tmp_path):
    x = np.arange(2000) * 0.5
    path = tmp_path / "p.csv"
    np.savetxt(path, np.c_[x, 900 * np.sin(x) + 500 * np.sin(1.7 * x)], delimiter=",", header="x [um],z [nm]")
    return path


def test_specularity_prints_its_value_and_warns_on_stderr(run):
    done = run(*SPHERE, "--rgb", "1,0.5,0.25", "--u-total", 0.005, "--alpha", 0.1, "--u-alpha", 0.01)
    assert done.code == 0, done
    assert "specularity" in done.out
    assert "u(alpha)" in done.out
    assert "plastic  5" in done.out
    assert "warning: the port takes about 17 % of a lobe" in done.err


def test_specularity_writes_a_radiance_material(run, tmp_path):
    done = run(*SPHERE, "--rgb", "1,0.5,0.25", "--alpha", 0.02, "-o", "paint.rad", "--name", "paint")
    assert done.code == 0, done
    text = (tmp_path / "paint.rad").read_text()
    assert "void plastic paint\n0\n0\n5 " in text
    assert text.startswith("# gonio specularity: 0.0")


def test_an_uncertainty_that_nobody_stated_is_not_printed_as_zero(run, tmp_path):
    paint = (*SPHERE, "--rgb", "1,0.5,0.25", "--alpha", 0.02, "-o", "paint.rad")
    done = run(*paint)
    assert done.out.count("(uncertainty not stated)") == 2
    assert "±" not in done.out
    assert "(uncertainty not stated)" in (tmp_path / "paint.rad").read_text().splitlines()[0]
    done = run(*paint, "--u-total", 0.005)
    assert done.out.count("(k = 2)") == 2
    assert "not stated" not in done.out
    assert "(k = 2)" in (tmp_path / "paint.rad").read_text().splitlines()[0]


def test_a_colour_too_saturated_for_the_reflectance_is_told(run, tmp_path):
    done = run(*SPHERE, "--rgb", "1,0,0", "--alpha", 0.02, "-o", "paint.rad")
    one_clear_error(done, "rgb", "red above 1", "too saturated for this reflectance")
    assert listing(tmp_path) == []


def test_specularity_as_json_carries_the_budget(run):
    done = run(*SPHERE, "--u-total", 0.005, "--json")
    found = json.loads(done.out)
    assert [i["name"] for i in found["inputs"]] == ["rho_total", "rho_diffuse", "port_half_angle", "plug"]
    assert found["u"] == pytest.approx(found["inputs"][0]["contribution"])
    assert found["rho_diffuse"] + found["rho_lobe"] == pytest.approx(0.55)
    assert found["radiance"] is None
    bare = json.loads(run(*SPHERE, "--json").out)
    assert (bare["u"], bare["u_rho_diffuse"], bare["inputs"][0]["u"]) == (None, None, None)


def test_the_combined_uncertainty_and_its_correlation_stand_below_the_budget(run):
    done = run(*SPHERE, "--u-total", 0.004, "--u-diffuse", 0.004, "--correlation", 0.9)
    assert "all of them combined (k = 1), correlation 0.9" in done.out


SATURATED = ("specularity", "--total", 0.55, "--diffuse", 0.012, "--port", 5, "--rgb", "1,0,0")
MORE_DIFFUSE = ("specularity", "--total", 0.5, "--diffuse", 0.512, "--port", 5)


def test_a_material_that_cannot_be_is_not_printed(run):
    done = run(*SATURATED, "--material", "metal")
    assert "metal  5" not in done.out
    assert "above 1" in done.err
    less = run(*MORE_DIFFUSE, "--rgb", "1,0.6,0.3")
    assert "the material has 0 and reflects" in less.err
    assert "smooth, roughness 0" in less.err


def test_roughness_of_a_file_prints_alpha_and_the_band(run, profile):
    done = run("roughness", profile, "--lambda-s", 2.5, "--lambda-c", 100)
    assert done.code == 0, done
    assert "R_dq" in done.out
    assert "2.5 to 100 um" in done.out


def test_roughness_as_json_carries_every_field(run, profile):
    found = json.loads(run("roughness", profile, "--json").out)
    assert found["alpha"] == pytest.approx(2**0.5 * found["rms_slope"])
    assert found["warnings"]
    assert found["direction"] is None


def test_colour_prints_a_line_a_column(run, spectrum):
    done = run("colour", spectrum)
    assert done.out.splitlines() == [
        "SCI  photopic 0.5000 (D65)  RGB 0.5000 0.5000 0.5000",
        "SCE  photopic 0.4000 (D65)  RGB 0.4000 0.4000 0.4000",
    ]


def test_colour_as_json_carries_the_illuminant(run, spectrum):
    found = json.loads(run("colour", spectrum, "--illuminant", "A", "--column", "SCE", "--json").out)
    assert found["illuminant"] == "A"
    assert [c["name"] for c in found["colours"]] == ["SCE"]


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("specularity", "--total", 55, "--diffuse", 50, "--port", 5), ("rho_total", "55", "percent")),
        ((*SPHERE, "--rgb", "1,2"), ("--rgb", "R,G,B")),
        ((*SPHERE, "-o", "m.rad"), ("--out", "--rgb")),
        ((*SPHERE, "--rgb", "1,0,0", "-o", "m.rad"), ("red", "too saturated")),
        ((*SPHERE, "--material", "wood"), ("wood",)),
        ((*SPHERE, "--alpha", 0.9), ("alpha", "cannot tell them apart")),
        (("specularity", "--total", 0.5, "--port", 5), ("--diffuse",)),
        (("roughness", "none.csv"), ("none.csv", "No such file")),
        (("roughness", "p.csv", "--spacing", "1,2,3"), ("--spacing",)),
        (("roughness", "p.csv", "--lambda-c", "1e6"), ("lambda_c", "allowed")),
        (("roughness", "s.csv"), ("s.csv", "3 columns")),
        (("roughness", "."), ("directory",)),
        (("colour", "none.csv"), ("none.csv", "No such file")),
        (("colour", "s.csv", "--illuminant", "D50"), ("illuminant", "D50")),
        (("colour", "s.csv", "--column", "XYZ"), ("column", "XYZ")),
        (("colour", "p.csv"), ("p.csv", "found wavelengths")),
    ],
)
def test_what_cannot_be_is_one_clear_error(run, spectrum, profile, tmp_path, arguments, names):
    one_clear_error(run(*arguments), *names)
    assert listing(tmp_path) == ["p.csv", "s.csv"]
