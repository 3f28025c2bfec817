import json

import gonio
import pytest

from tests.cli.conftest import listing, one_clear_error


def test_process_saves_a_measurement_and_states_the_reflectance(process, tmp_path):
    done = process()
    assert done.code == 0, done.err
    assert "DHR" in done.out
    measurement = gonio.Measurement.load(tmp_path / "out")
    (integral,) = measurement.slices[0].integrals
    assert integral.value == pytest.approx(0.5, abs=0.005)
    assert measurement.sample_name == "half white"
    assert measurement.signature_fwhm == pytest.approx(0.5, abs=0.1)
    assert listing(tmp_path) == ["out"]


def test_json_is_one_object_and_nothing_else(process):
    done = process("--json")
    assert done.code == 0
    found = json.loads(done.out)
    assert found["slices"][0]["theta_i"] == pytest.approx(30)
    assert found["slices"][0]["integrals"][0]["side"] == "front"


def test_provenance_names_every_file_with_its_hash_and_the_settings(process, campaign, tmp_path):
    process("--u-angle", "0.01")
    provenance = gonio.Measurement.load(tmp_path / "out").provenance
    assert [(i["name"], i["role"], len(i["sha256"])) for i in provenance["inputs"]] == [
        ("sample.txt", "sample", 64),
        ("beam.txt", "beam", 64),
        ("dark.txt", "dark", 64),
    ]
    assert provenance["settings"]["u_angle"] == 0.01
    assert provenance["gonio"] == gonio.__version__
    assert provenance["processing"]["beams"][0]["power"] == pytest.approx(1.0, rel=1e-3)


def test_the_netcdf_is_written_on_demand(process, tmp_path):
    assert process("--netcdf", tmp_path / "m.nc").code == 0
    assert listing(tmp_path) == ["m.nc", "out"]


def test_scans_in_memory_and_files_mix(campaign):
    sample = gonio.read(campaign / "sample.txt")
    measurement = gonio.process(sample, beam=campaign / "beam.txt", dark=[campaign / "dark.txt"])
    assert [i["role"] for i in measurement.provenance["inputs"]] == ["beam", "dark"]


def test_kinds_in_one_file_are_told_apart(campaign, tmp_path):
    both = gonio.read([campaign / "sample.txt", campaign / "beam.txt", campaign / "dark.txt"])
    both.save(tmp_path / "all.parquet")
    assert len(gonio.process(tmp_path / "all.parquet")) == 1


def test_progress_is_reported_from_first_to_last(campaign):
    seen = []
    gonio.process(
        campaign / "sample.txt", beam=campaign / "beam.txt", progress=lambda *step: seen.append(step)
    )
    assert seen[0] == ("reading", 0, 2)
    assert ("reading", 2, 2) in seen
    assert seen[-1] == ("processing", 1, 1)


def test_a_directory_with_other_files_is_refused_before_the_work(process, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.tex").write_text("")
    one_clear_error(process(), "out", "other files", "--force")
    assert process("--force").code == 0
    assert "thesis.tex" in listing(tmp_path / "out")


def test_the_extrapolated_part_is_a_share_of_the_integral(process, tmp_path):
    done = process()
    (integral,) = gonio.Measurement.load(tmp_path / "out").slices[0].integrals
    share = 100 * integral.extrapolated / integral.value
    assert f"{share:.1f} % of it extrapolated" in done.out


def test_readings_in_one_plane_have_no_integral_and_that_is_told(run, tmp_path):
    theta_s = [5.0, 20.0, 40.0, 60.0, 80.0]
    scan = gonio.Scan(
        quantity="bsdf", theta_i=30, phi_i=0, theta_s=theta_s, phi_s=[180.0] * 5, value=[0.1] * 5
    )
    gonio.Readings([scan]).save(tmp_path / "plane.txt")
    done = run("process", tmp_path / "plane.txt", "-o", "out")
    assert done.code == 0
    assert "no DHR or DHT: the usable readings cover less than a tenth" in done.out
