import json

import gonio
import numpy as np
import pytest
from gonio import analytic, compact_files
from gonio.compact_files import read_compact

from tests.cli.conftest import one_clear_error

DIRECTIONS = {"theta_i": 40.0, "phi_i": 20.0, "theta_s": np.linspace(0, 85, 18), "phi_s": 200.0}


@pytest.fixture(scope="module")
def paint():
    return analytic({"model": "lambert", "rho": 0.3}, {"model": "beckmann", "f0": 0.05, "alpha": 0.15})


@pytest.fixture(scope="module")
def file(paint, tmp_path_factory):
    path = tmp_path_factory.mktemp("compact") / "paint.nc"
    gonio.reduce(paint, out=path, components=[("front", "reflection")], name="paint")
    return path


def changed(file, to, change):
    """A copy of a compact file with `change(attributes, variables)` done to it and a checksum that holds."""
    attributes, variables = compact_files._opened(file)
    change(attributes, variables)
    to.write_bytes(compact_files._signed(attributes, variables))
    return to


def test_a_compact_file_is_small_and_close_to_its_model(paint, file):
    assert file.stat().st_size < 16_000
    found = gonio.compare(paint, file, components=[("front", "reflection")])
    total = found.summary["photopic", "front", "reflection"]
    assert total["rel_l1"] < 0.01
    assert abs(total["dhr_difference"]) < 0.005
    assert 0.95 < total["peak_ratio"] < 1.05


def test_what_is_read_is_what_was_written_to_the_last_bit(paint, tmp_path):
    brushed = analytic(
        {"model": "lambert", "rho": {"red": 0.1, "green": 0.2}},
        {
            "model": "ward-duer-anisotropic",
            "rho": {"red": 0.3, "green": 0.2},
            "alpha_x": 0.1,
            "alpha_y": 0.3,
            "phi_x": 25.0,
        },
    )
    made = gonio.reduce(brushed, out=tmp_path / "a.nc", components=[("front", "reflection")], target=0.03)
    gonio.write_compact(tmp_path / "b.nc", read_compact(tmp_path / "a.nc"), name="Löß, gebürstet")
    assert gonio.inspect([tmp_path / "b.nc"]).files[0].sample_name == "Löß, gebürstet"
    for name in ("a.nc", "b.nc"):
        read = gonio.read_bsdf(tmp_path / name)
        assert read.channels == ["red", "green"]
        assert read.properties == made.model.properties
        for channel in read.channels:
            np.testing.assert_array_equal(
                read.eval(**DIRECTIONS, channel=channel), made.model.eval(**DIRECTIONS, channel=channel)
            )
        np.testing.assert_array_equal(read.pdf(**DIRECTIONS), made.model.pdf(**DIRECTIONS))


def test_every_damage_is_told_as_such(run, file, tmp_path):
    whole = file.read_bytes()
    rng = np.random.default_rng(4)
    for k in range(60):
        damaged = bytearray(whole)
        if k % 3 == 0:
            damaged = damaged[: int(rng.integers(8, len(whole) - 8))]
        else:
            at = int(rng.integers(8, len(whole)))
            damaged[at] ^= int(rng.integers(1, 256))
        path = tmp_path / "damaged.nc"
        path.write_bytes(damaged)
        with pytest.raises(gonio.FormatError, match=r"damaged\.nc"):
            gonio.read_bsdf(path)
    path.write_bytes(whole[:-200])
    one_clear_error(run("inspect", path), "damaged.nc", "damaged")


def test_files_of_other_formats_and_newer_versions_are_refused_with_what_to_do(run, file, tmp_path):
    newer = changed(
        file, tmp_path / "newer.nc", lambda a, _: a.update(format_version=np.int32(2), gonio="9.0")
    )
    one_clear_error(
        run("reduce", newer, "-o", tmp_path / "x.nc"), "newer.nc", "found 2", "newer gonio", "9.0"
    )
    other = changed(file, tmp_path / "other.nc", lambda a, _: a.update(format="weather"))
    one_clear_error(run("compare", other, file), "other.nc", "weather", "gonio-compact")

    def unknown_lobe(_, variables):
        about = variables["front_reflection"][2]
        about["base"] = about["base"].replace("lambert", "lumbert")

    odd = changed(file, tmp_path / "odd.nc", unknown_lobe)
    one_clear_error(run("inspect", odd), "odd.nc", "lumbert")
    shape = changed(file, tmp_path / "shape.nc", lambda _, v: v.pop("front_reflection_step"))
    one_clear_error(run("inspect", shape), "shape.nc", "front_reflection_step")


def test_reduce_prints_the_loss_and_inspect_the_table(run, file, tmp_path):
    done = run("reduce", file, "-o", tmp_path / "again.nc", "--target", "0.02", "--json")
    found = json.loads(done.out)
    assert found["bytes"] == (tmp_path / "again.nc").stat().st_size
    assert found["loss"]["summary"][0]["rel_l1"] < 0.02
    assert found["error"]["front-reflection"][0] <= 0.02
    done = run("reduce", file, "-o", tmp_path / "again.nc", "--max-bytes", "600")
    assert (done.code, "relative L1" in done.out, "reciprocity" in done.out) == (0, True, True)
    done = run("inspect", tmp_path / "again.nc", "--json")
    inspected = json.loads(done.out)["files"][0]
    assert inspected["format"] == "gonio-compact"
    assert inspected["model"]["components"][0]["representation"] == "compact"


def test_options_out_of_range_are_refused_before_anything_is_written(run, file, tmp_path):
    out = tmp_path / "new.nc"
    one_clear_error(run("reduce", file, "-o", out, "--target", "0"), "target", "0.0001 to 1")
    one_clear_error(run("reduce", file, "-o", out, "--bits", "12"), "bits", "8 or 16")
    one_clear_error(run("reduce", file, "-o", out, "--channel", "red"), "channel", "red", "photopic")
    one_clear_error(run("reduce", file, "-o", tmp_path / "no" / "x.nc"), "no such directory")
    assert not out.exists()


def test_a_compact_file_is_exported_fitted_tabulated_and_measured_again(run, file, tmp_path):
    assert (
        run("export", file, "--to", "radiance-klems", "--basis", "quarter", "-o", tmp_path / "p.xml").code
        == 0
    )
    klems = gonio.read_bsdf(tmp_path / "p.xml")
    loss = gonio.compare(file, klems, incidences=[(0.0, 0.0)]).rows[0]
    assert loss.dhr_b == pytest.approx(loss.dhr_a, rel=0.05)
    one_clear_error(run("export", file, "--to", "csv", "-o", tmp_path / "p.csv"), "found a model")
    found = gonio.fit(file, model="ward-gmd", held_out=False)
    assert found.estimate("kd").value == pytest.approx(0.3, abs=0.02)
    done = run(
        "simulate",
        "--material",
        file,
        "-o",
        tmp_path / "camp",
        "--incidence",
        "30,0",
        "--instrument",
        "pitch_across=10",
    )
    assert done.code == 0
    assert (tmp_path / "camp" / "beam.txt").is_file()
