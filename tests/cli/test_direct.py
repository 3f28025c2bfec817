"""Light that passes unscattered, from the virtual instrument to an aBSDF file."""

import json

import gonio
import numpy as np
import pytest

CURTAIN = "void trans curtain\n0\n0\n7 .8 .8 .8 0 0 .6 .5\n"
THROUGH = 0.8 * 0.6 * 0.5
"""Share that a trans without roughness passes straight: C T t_s."""


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    folder = tmp_path_factory.mktemp("curtain")
    material = folder / "curtain.rad"
    material.write_text(CURTAIN)
    gonio.simulate(
        material=material,
        out=folder / "raw",
        incidences=[(0, 0), (20, 0), (40, 0), (60, 0)],
        components=["transmission"],
        instrument={"patch_pitch": 0.08},
        seed=3,
    )
    samples = sorted((folder / "raw").glob("sample*.txt"))
    gonio.process(
        samples, beam=[folder / "raw" / "beam.txt"], dark=[folder / "raw" / "dark.txt"], out=folder / "m"
    )
    return folder / "m"


def test_what_the_virtual_instrument_saw_unscattered_is_told_apart(run, measured):
    done = run("build", measured, "--channel", "green", "--json")
    assert done.code == 0, done.err
    direct = json.loads(done.out)["direct"]
    assert [round(row["theta_i"]) for row in direct] == [0, 20, 40, 60]
    for row in direct:
        assert row["component"] == "transmission"
        # 3 standard uncertainties; false alarm 1 % over the four incidences
        assert abs(row["share"] - THROUGH) < 3 * row["u_share"], row
        assert row["u_share"] < 0.01
    assert "unscattered" in done.err
    model = gonio.build(measured, channel="green")
    straight = model.delta(theta_i=30, phi_i=0, component="transmission")
    np.testing.assert_allclose(straight["theta_s"], 150.0, atol=1e-6)
    f = model.eval(theta_i=30, phi_i=0, theta_s=[149.0, 145.0, 120.0], phi_s=180.0)
    np.testing.assert_allclose(f, 0.24 / np.pi, rtol=0.02)
    # What lies under the peak is not read; it holds a few millionths of the light.
    assert model.eval(theta_i=30, phi_i=0, theta_s=150, phi_s=180)[()] < 1
    whole = gonio.build(measured, channel="green", direct=False)
    assert not whole.has_delta
    assert whole.direct == []
    assert whole.eval(theta_i=20, phi_i=0, theta_s=160, phi_s=180)[()] > 1000


def test_klems_patches_hold_the_unscattered_light(run, measured, tmp_path):
    target = tmp_path / "c.xml"
    options = ("--channel", "green", "--as-visible", "-o", target)
    done = run("export", measured, "--to", "radiance-klems", *options)
    assert done.code == 0, done.err
    assert "aBSDF" in done.err
    klems = gonio.read_radiance(target)
    albedo = gonio._native.directional_albedo(klems, theta_i=30, phi_i=0, component="transmission")
    assert albedo == pytest.approx(0.48, abs=0.02)


def test_a_peak_between_the_readings_is_in_the_uncertainty_of_the_transmittance(run, tmp_path):
    material = tmp_path / "curtain.rad"
    material.write_text(CURTAIN)
    for pitch in (0.25, 0.5):
        raw = tmp_path / f"raw{pitch}"
        gonio.simulate(
            material=material,
            out=raw,
            incidences=[(0, 0), (40, 0)],
            components=["transmission"],
            instrument={"patch_pitch": pitch},
            seed=3,
        )
        found = gonio.process(
            sorted(raw.glob("sample*.txt")),
            beam=[raw / "beam.txt"],
            dark=[raw / "dark.txt"],
            out=tmp_path / f"m{pitch}",
        )
        assert any("too few of them" in w for w in found.warnings)
        for part in (i for s in found.slices for i in s.integrals if i.side == "back"):
            # Half of the light goes straight on; k = 2
            assert 0.02 < abs(part.value - 2 * THROUGH) < 2 * part.u < 0.4


def test_the_compact_model_of_a_measurement_keeps_the_unscattered_light(run, measured, tmp_path):
    incidence = {"theta_i": 30.0, "phi_i": 0.0, "component": "transmission"}
    full = gonio.build(measured, channel="green").delta(**incidence)
    options = ("--channel", "green", "--target", "0.02")
    for verb, name in (("build", "a.nc"), ("reduce", "b.nc")):
        done = run(verb, measured, "-o", tmp_path / name, *options)
        assert done.code == 0, done.err
        found = gonio.read_bsdf(tmp_path / name).delta(**incidence)
        assert found["theta_s"][()] == pytest.approx(full["theta_s"][()], abs=1e-6)
        assert found["share"][()] == pytest.approx(full["share"][()], abs=0.003)
        done = run(verb, measured, "-o", tmp_path / f"peak-{name}", "--no-direct", *options)
        assert done.code == 0, done.err
        assert not gonio.read_bsdf(tmp_path / f"peak-{name}").has_delta
