"""`gonio plan`: a path for target uncertainties, and what it says it misses."""

import json
import math

import gonio
import pytest

from .conftest import one_clear_error


@pytest.fixture
def plan(run):
    def call(*arguments: str) -> dict:
        result = run("plan", *arguments, "--json")
        assert result.code == 0, result.err
        return json.loads(result.out)

    return call


def test_a_plan_is_simulated_as_it_is_and_reaches_its_targets(tmp_path, plan):
    out = tmp_path / "plan"
    found = plan("plastic", "--incidence", "30,0", "--incidence", "65,20", "-o", str(out))
    assert found["met"]
    assert (out / "path.png").stat().st_size > 5000
    assert json.loads((out / "plan.json").read_text())["readings"] == found["readings"]
    raw = tmp_path / "raw"
    campaign = gonio.simulate(
        material="plastic",
        instrument=out / "instrument.toml",
        incidences=[(30.0, 0.0), (65.0, 20.0)],
        seed=8,
        out=raw,
    )
    assert campaign.readings == found["readings"]
    device = gonio.read_instrument(out / "instrument.toml")
    measured = gonio.process(
        campaign.sample, beam=campaign.beam, dark=campaign.dark, u_calibration=device.u_calibration
    )
    truth = campaign.material
    for s in measured.slices:
        whole = truth.directional_hemispherical(theta_i=s.theta_i, phi_i=s.phi_i, side="front")
        (integral,) = s.integrals
        assert integral.u / whole <= 0.005
        assert abs(integral.value / whole - 1.0) <= 2 * 0.005
        _, top, u, _ = s.highest("front")
        assert u / top <= 0.012


def test_a_fast_scan_is_enough_to_plan_with(tmp_path, plan):
    gonio.simulate(
        material="metal",
        instrument="pgII-like",
        settings={"pitch_across": 6.0, "pitch_along": 3.0},
        incidences=[(20.0, 0.0), (60.0, 0.0)],
        out=tmp_path / "fast",
    )
    found = plan(str(tmp_path / "fast"))
    places = [(s["theta_i"], s["component"]) for s in found["scans"]]
    assert places == [(20.0, "reflection"), (60.0, "reflection")]
    for s in found["scans"]:
        # A lobe of alpha .1 is twice that wide, and narrower by cos theta_i across the plane of incidence.
        along, across = s["lobes"][0]["width"]
        assert along == pytest.approx(11.4, rel=0.05)
        assert across == pytest.approx(11.4 * math.cos(math.radians(s["theta_i"])), rel=0.05)


def test_more_time_buys_a_better_path_and_less_time_is_said(plan):
    arguments = ("metal", "--incidence", "75,0", "--target-peak", "0.004", "--target-dhr", "0.002")
    arguments += ("--instrument", "noise_relative=0.0005")
    free = plan(*arguments)
    short = plan(*arguments, "--minutes", "2.7")
    assert short["seconds"] <= 2.7 * 60 < free["seconds"]
    (scan,), (other,) = short["scans"], free["scans"]
    assert max(scan["u_peak"] / 0.004, scan["u_integral"] / 0.002) > max(
        other["u_peak"] / 0.004, other["u_integral"] / 0.002
    )
    assert scan["missed"] == "time"
    assert not short["met"]
    assert any("time is used up" in m for m in short["misses"])


def test_a_region_is_read_whatever_is_known(plan):
    found = plan("lambert", "--incidence", "40,0", "--region", "50,90,5,1")
    (scan,) = found["scans"]
    (lobe,) = scan["lobes"]
    assert lobe["at"] == pytest.approx([50.0, 90.0])
    assert lobe["height"] == 0.0
    without = plan("lambert", "--incidence", "40,0")
    # A disk of five degrees read at one degree.
    assert found["readings"] - without["readings"] == pytest.approx(78, abs=15)


def test_the_command_that_is_named_simulates_the_plan(run, tmp_path):
    done = run("plan", "metal", "--incidence", "30,0", "--target-peak", "0.05", "-o", "plan")
    assert done.code == 0, done.err
    command = done.out.splitlines()[-1].partition("gonio ")[2]
    assert "--material metal" in command
    done = run(*command.split())
    assert done.code == 0, done.err
    assert list((tmp_path / "scan").glob("sample*.txt"))


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--target-dhr", "0"), "target_dhr: found 0, allowed more than 0"),
        (("--target-peak", "1.5"), "target_peak: found 1.5"),
        (("--target-dhr", "nan"), "target_dhr: found nan"),
        (("--minutes", "-3"), "minutes: found -3"),
        (("--minutes", "0.2"), "allowed at least"),
        (("--largest-pitch", "90"), "largest_pitch: found 90"),
        (("--region", "200,0,5,1"), "outside of the sphere"),
        (("--region", "20,0,500,1"), "radius 500"),
        (("--region", "20,0"), "THETA,PHI,RADIUS,PITCH"),
        (("--instrument", "nope"), "instrument: found 'nope'"),
        (("--incidence", "90,0"), "theta_i = 90"),
        (("--component", "transmission"), "no light to read"),
    ],
)
def test_bad_input_is_one_clear_error(tmp_path, run, arguments, told):
    one_clear_error(run("plan", "plastic", *arguments, "-o", "out"), told)
    assert not list(tmp_path.iterdir())
