"""`gonio surface`: height maps as geometry."""

import json
import shlex

import gonio
import numpy as np
import pytest

from tests.cli.conftest import one_clear_error

MEASURED = ("--spacing", ".5", "--x-unit", "um", "--z-unit", "nm")


@pytest.fixture
def height_map(tmp_path):
    """A wavy map of 24 x 16 points in nanometres that repeats by itself."""
    y, x = np.mgrid[:16, :24]
    z = 300.0 * np.sin(2 * np.pi * x / 24) * np.cos(2 * np.pi * y / 16)
    np.save(tmp_path / "map.npy", z)
    return z


def test_a_height_map_becomes_geometry_and_the_printed_commands_measure_it(run, tmp_path, height_map):
    done = run("surface", "map.npy", "-o", "rough map.rad", *MEASURED, "--joins")
    assert done.code == 0, done.err
    assert "period 12 x 8 um" in done.out
    bsdf, readings = (line.split(": ", 1)[1] for line in done.out.splitlines()[-2:])
    measured = run(*shlex.split(bsdf)[1:], "--basis", "quarter", "--rays", "256", "--json")
    assert measured.code == 0, measured.err
    assert json.loads(measured.out)["window"] == [0, 0, 12, 8]
    model = gonio.read_bsdf(tmp_path / "rough map.xml")
    # Mirrors lose nothing; 256 rays leave 2 % of noise.
    assert model.albedo(side="front", component="reflection")[0] == pytest.approx(1.0, abs=0.06)
    coarse = ["pitch_across=20", "pitch_along=10", "patch_pitch=2", "patch_radius=4"]
    settings = [word for setting in coarse for word in ("--instrument", setting)]
    scan = run(*shlex.split(readings)[1:], "--incidence", "30,0", *settings, "--json")
    assert scan.code == 0, scan.err
    assert (tmp_path / "scan" / "beam.txt").is_file()


def test_as_json_it_says_what_simulate_needs(run, tmp_path, height_map):
    done = run(
        "surface", "map.npy", "-o", "m.rad", *MEASURED, "--material", "metal", "--value", ".9", "--json"
    )
    found = json.loads(done.out)
    # Mirrored: a map of n points has a period of 2 (n - 1) steps.
    assert found["window"] == [0, 0, 23, 15]
    assert found["unit"] == 1e-6
    assert found["rms_slope"] == pytest.approx(
        0.5 * np.hypot(0.3 * 2 * np.pi / 12, 0.3 * 2 * np.pi / 8), rel=0.05
    )
    assert found["mesh"] == "m.ply"
    assert "void metal surface" in (tmp_path / "m.rad").read_text()
    assert ".9 .9 .9" in (tmp_path / "m.rad").read_text().replace("0.9", ".9")


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (("map.npy", "-o", "m.obj", *MEASURED), ("out", "m.obj", ".rad")),
        (("map.npy", "-o", "m.rad"), ("map.npy", "z_unit")),
        (("map.npy", "-o", "m.rad", "--spacing", "1,2,3"), ("--spacing",)),
        (("map.npy", "-o", "m.rad", *MEASURED, "--material", "wood"), ("--material", "wood", "dielectric")),
        (("map.npy", "-o", "m.rad", *MEASURED, "--value", "2"), ("value: found 2", "0 to 1")),
        (("holes.npy", "-o", "m.rad", *MEASURED), ("holes.npy", "without holes")),
        (("line.csv", "-o", "m.rad"), ("line.csv", "found a profile")),
        (("none.npy", "-o", "m.rad", *MEASURED), ("none.npy", "No such file")),
        (("map.npy", *MEASURED), ("--out",)),
    ],
)
def test_what_is_no_height_map_is_one_error_and_writes_nothing(run, tmp_path, height_map, arguments, names):
    np.save(tmp_path / "holes.npy", np.where(np.arange(24) == 3, np.nan, height_map))
    (tmp_path / "line.csv").write_text("x_um,z_um\n" + "".join(f"{0.1 * k},{k % 3}\n" for k in range(99)))
    one_clear_error(run("surface", *arguments), *names)
    assert not list(tmp_path.glob("m.*"))
