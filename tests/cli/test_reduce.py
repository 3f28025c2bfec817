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
        file, tmp_path / "newer.nc", lambda a, _: a.update(format_version=np.int32(3), gonio="9.0")
    )
    one_clear_error(
        run("reduce", newer, "-o", tmp_path / "x.nc"), "newer.nc", "found 3", "newer gonio", "9.0"
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


def as_version_1(model, to):
    """The file that version 1 of the format would be: codes one by one."""
    attributes = {
        "format": "gonio-compact",
        "format_version": np.int32(1),
        "gonio": "0.1.0",
        "name": "old",
        "channels": " ".join(model.channels),
        "energy_conserving": np.int32(1),
        "provenance": "{}",
    }
    variables = {}
    for part in model.parts():
        key = f"{part['side']}_{part['component']}"
        axes = tuple(f"{key}_{axis}" for axis in ("theta_i", "phi_i", "u", "phi_h"))
        about = {
            "symmetry": part["symmetry"],
            "width": np.array(part["width"]),
            "phi_x": np.float64(part["phi_x"]),
            "base": json.dumps(part["base"]),
        }
        codes = part["codes"].astype(np.int8)
        assert (codes == part["codes"]).all()
        variables[key] = (("channel", *axes), codes, about)
        for word in ("offset", "step"):
            variables[f"{key}_{word}"] = (("channel", axes[0]), part[word], {})
        variables[axes[0]] = ((axes[0],), part["theta_i"], {})
    to.write_bytes(compact_files._signed(attributes, variables))
    return to


def test_files_of_version_1_are_read_and_written_anew(run, paint, tmp_path):
    made = gonio.reduce(paint, components=[("front", "reflection")], bits=8).model
    old = as_version_1(made, tmp_path / "old.nc")
    read = gonio.read_bsdf(old)
    np.testing.assert_array_equal(read.eval(**DIRECTIONS), made.eval(**DIRECTIONS))
    np.testing.assert_array_equal(read.pdf(**DIRECTIONS), made.pdf(**DIRECTIONS))
    gonio.write_compact(tmp_path / "new.nc", read)
    np.testing.assert_array_equal(
        gonio.read_bsdf(tmp_path / "new.nc").eval(**DIRECTIONS), made.eval(**DIRECTIONS)
    )
    assert run("inspect", old).code == 0


def test_a_lobe_about_the_incidence_goes_through_a_file(file, tmp_path):
    plain = read_compact(file)
    parts = plain.parts()
    retro = {"model": "round-retro-lobe", "weight": 0.1, "parameters": {"kr": [0.2], "alpha_r": [0.15]}}
    parts[0]["base"].append(retro)
    made = gonio._native.compact_of(plain.channels, parts, energy_conserving=True)
    gonio.write_compact(tmp_path / "beads.nc", made)
    read = read_compact(tmp_path / "beads.nc")
    about = {"theta_i": 40.0, "phi_i": 20.0, "theta_s": np.linspace(0, 85, 18), "phi_s": 20.0}
    np.testing.assert_array_equal(read.eval(**about), made.eval(**about))
    np.testing.assert_array_equal(read.pdf(**about), made.pdf(**about))
    assert made.eval(**about).max() > 2 * plain.eval(**about).max()
    assert [lobe["model"] for lobe in read.parts()[0]["base"]][-1] == "round-retro-lobe"


def test_tables_that_do_not_fit_their_shape_are_refused(run, file, tmp_path):
    def shorter(_, variables):
        dims, codes, about = variables["front_reflection"]
        variables["front_reflection"] = (dims, codes[:-30], about)

    def larger(_, variables):
        about = variables["front_reflection"][2]
        about["shape"] = np.array([2, 1, 2, 2], dtype=np.int32)

    def without(_, variables):
        del variables["front_reflection"][2]["shape"]

    one_clear_error(run("inspect", changed(file, tmp_path / "a.nc", shorter)), "a.nc", "lengths")
    one_clear_error(run("inspect", changed(file, tmp_path / "b.nc", larger)), "b.nc", "codes")
    one_clear_error(run("inspect", changed(file, tmp_path / "c.nc", without)), "c.nc", "shape")


@pytest.fixture(scope="module")
def screen(tmp_path_factory):
    """A Radiance material that scatters, mirrors and lets light through unscattered."""
    path = tmp_path_factory.mktemp("screen") / "screen.rad"
    path.write_text("void trans screen 0 0 7 0.9 0.4 0.8 0.1 0 0.6 0.7\n")
    return path


def test_unscattered_light_goes_through_a_file_and_back(run, screen, tmp_path):
    out = tmp_path / "screen.nc"
    done = run("reduce", screen, "-o", out, "--json")
    assert done.code == 0, done.err
    found = json.loads(done.out)
    assert max(found["unscattered_error"].values()) < 0.006
    full, read = gonio.read_bsdf(screen), gonio.read_bsdf(out)
    assert read.has_delta
    incidence = {"theta_i": [0.0, 25.0, 60.0, 130.0], "phi_i": 15.0}
    for component in ("reflection", "transmission"):
        for channel in full.channels:
            a = full.delta(**incidence, component=component, channel=channel)
            b = read.delta(**incidence, component=component, channel=channel)
            np.testing.assert_allclose(b["theta_s"], a["theta_s"], atol=1e-6)
            np.testing.assert_allclose(b["share"], a["share"], atol=0.006)
    assert "unscattered" in run("inspect", out).out
    gonio.write_compact(tmp_path / "again.nc", read)
    again = gonio.read_bsdf(tmp_path / "again.nc")
    for key in ("theta_s", "share"):
        np.testing.assert_array_equal(
            again.delta(**incidence, component="transmission", channel="green")[key],
            read.delta(**incidence, component="transmission", channel="green")[key],
        )


def test_a_mirror_alone_is_a_file_without_a_table(run, tmp_path):
    source, out = tmp_path / "mirror.rad", tmp_path / "mirror.nc"
    source.write_text("void mirror polished 0 0 3 0.8 0.8 0.8\n")
    done = run("reduce", source, "-o", out)
    assert (done.code, "unscattered light alone" in done.out) == (0, True), done.err
    read = gonio.read_bsdf(out)
    straight = read.delta(theta_i=30.0, phi_i=0.0, component="reflection", channel="red")
    assert straight["share"][()] == pytest.approx(0.8, abs=1e-3)
    assert run("inspect", out).code == 0


def test_a_target_out_of_reach_is_warned_of_and_the_file_written(run, screen, file, tmp_path):
    out = tmp_path / "rough.nc"
    done = run("reduce", file, "-o", out, "--target", "0.0001", "--max-bytes", "500")
    assert done.code == 0
    assert "front reflection" in done.err
    assert "target of 0.01 % was not reached" in done.err
    assert out.exists()
    done = run("reduce", file, "-o", out, "--target", "0.02")
    assert "not reached" not in done.err


def test_the_model_that_is_read_is_not_overwritten(run, file, tmp_path):
    own = tmp_path / "own.nc"
    own.write_bytes(file.read_bytes())
    link = tmp_path / "link.nc"
    link.symlink_to(own)
    for out in (own, link):
        one_clear_error(run("reduce", own, "-o", out), "another file is needed")
    assert own.read_bytes() == file.read_bytes()
