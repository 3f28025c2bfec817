"""The chain on known materials: what a measurement claims about its own errors is true."""

import dataclasses
import json

import gonio
import numpy as np
import pytest
from gonio.materials import MATERIALS, material
from gonio.truth import compare

REDUCED = [(8.0, 0.0), (50.0, 0.0), (75.0, 0.0)]


def measured(name, seed, tmp_path, incidences=None):
    campaign = gonio.simulate(material=name, seed=seed, incidences=incidences, out=tmp_path / "raw")
    measurement = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    return campaign, compare(measurement, material=campaign.material)


def claims(c):
    return {
        "outside": [(i.theta_i, i.name, i.error, i.expanded) for i in c.integrals if not i.held],
        "expanded": c.dhr_expanded_uncertainty_max,
        "median": c.dsf_error_median,
        "coverage": c.coverage_95,
    }


# A beam power stated without margin would put one seed in twenty outside k = 2; the seeds are fixed.
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", ["plastic", "metal", "satin-glass"])
def test_every_claim_of_a_measurement_holds_against_the_truth(name, seed, tmp_path):
    _, comparison = measured(name, seed, tmp_path, REDUCED)
    assert comparison.held, claims(comparison)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3, 4])
@pytest.mark.parametrize("name", sorted(MATERIALS))
def test_every_claim_holds_for_whole_campaigns_of_every_named_material(name, seed, tmp_path):
    campaign, comparison = measured(name, seed, tmp_path)
    assert campaign.readings >= 100_000
    assert len(campaign.sample) >= 6
    assert comparison.held, claims(comparison)


@pytest.mark.slow
def test_the_demo_writes_every_product_and_the_same_figures_again(tmp_path):
    result = gonio.demo(out=tmp_path / "demo")
    first = result.to_dict()
    assert list(first) == [
        "readings",
        "dhr_error_max",
        "dhr_expanded_uncertainty_max",
        "dsf_error_median",
        "coverage_95",
        "seconds",
    ]
    assert result.held, claims(result.comparison)
    assert result.report.stat().st_size > 100_000
    assert len(gonio.Measurement.load(result.measured).slices) == len(result.campaign.sample)
    assert {p.name for p in (tmp_path / "demo").rglob("*.xml")} == {
        "radiance-klems.xml",
        "radiance-ttree.xml",
    }
    second = gonio.demo(out=tmp_path / "demo").to_dict()
    assert first | {"seconds": 0} == second | {"seconds": 0}


def test_raw_files_tell_nothing_of_the_material(tmp_path):
    campaign = gonio.simulate(seed=5, incidences=[(30.0, 0.0)], out=tmp_path / "raw")
    scans = gonio.read([*campaign.sample, *campaign.beam, *campaign.dark])
    assert {s.kind for s in scans} == {"sample", "beam", "dark"}
    assert {s.quantity for s in scans} == {"signal"}
    assert {key for s in scans for key in s.meta} <= {
        "sample_name",
        "instrument",
        "distance",
        "receiver_solid_angle",
        "beam_diameter",
        "saturation",
        "started",
        "source",
    }
    assert json.loads((tmp_path / "raw" / "campaign.json").read_text())["seed"] == 5


def test_a_wrong_material_is_found_out(tmp_path):
    campaign = gonio.simulate(seed=1, incidences=[(30.0, 0.0)], out=tmp_path / "raw")
    measurement = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    other = dataclasses.replace(campaign.material, bsdf=material("lambert").bsdf)
    comparison = compare(measurement, material=other)
    assert not comparison.held
    assert comparison.coverage_95 < 0.5


@pytest.mark.parametrize("name", sorted(MATERIALS))
def test_named_materials_scatter_no_more_than_all_light(name):
    m = material(name)
    for theta_i in (0.0, 30.0, 60.0, 80.0, 89.0, 150.0):
        total = sum(
            m.directional_hemispherical(theta_i=theta_i, phi_i=20.0, side=side) for side in ("front", "back")
        )
        assert 0.0 < total < 1.0


def test_the_true_dsf_of_a_material_is_its_bsdf_times_the_cosine():
    theta_s = np.array([0.0, 60.0, 120.0])
    dsf = material("lambert").dsf(theta_i=10.0, phi_i=0.0, theta_s=theta_s, phi_s=0.0)
    np.testing.assert_allclose(dsf, [0.6 / np.pi, 0.3 / np.pi, 0.0], rtol=1e-12)


def test_unknown_materials_and_settings_are_refused_by_name(tmp_path):
    with pytest.raises(gonio.DomainError, match=r"material: found 'wood', allowed plastic"):
        gonio.simulate(material="wood", out=tmp_path / "raw")
    with pytest.raises(gonio.DomainError, match=r"instrument: found \"colour\""):
        gonio.simulate(instrument={"colour": 1.0}, out=tmp_path / "raw")
    with pytest.raises(gonio.DomainError, match=r"seed: found -1"):
        gonio.simulate(seed=-1, out=tmp_path / "raw")
    with pytest.raises(gonio.DomainError, match=r"incidences: found theta_i = 89.5"):
        gonio.simulate(incidences=[(89.5, 0.0)], out=tmp_path / "raw")
    assert not (tmp_path / "raw").exists()
