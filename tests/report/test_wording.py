"""Sentences and facts of the report in the reader's notation."""

import gonio
import pytest
from gonio._drawing.numbers import percent, rounded
from gonio.reporting.header import describe, verdict_row
from gonio.reporting.page import render_report
from gonio.reporting.wording import in_symbols, when

from . import samples
from .test_report import Page, page_of


@pytest.mark.parametrize(
    ("plain", "shown"),
    [
        ("at theta_i 8.00, phi_i 0.00 deg", "at θi\u00a08°, φi\u00a00°"),
        ("theta_s 12.50, phi_s 180.00 deg", "θs\u00a012.5°, φs\u00a0180°"),
        ("a floor of 1.45e-4 1/sr", "a floor of 1.45·10⁻⁴ 1/sr"),
        ("ends 1.6 deg above", "ends 1.6° above"),
        ("the -0.03 ± 0.01 power", "the −0.03 ± 0.01 power"),
        ("650nm", "650\u00a0nm"),
        ("ptfe_532nm_i15.txt, 2026-01-05, rank 3-4", "ptfe_532nm_i15.txt, 2026-01-05, rank 3-4"),
    ],
)
def test_a_sentence_of_the_core_is_written_in_symbols(plain, shown):
    assert in_symbols(plain) == shown


def test_a_time_stamp_is_written_to_the_minute_and_other_text_stays():
    assert when("2026-01-05T08:00:59Z") == "2026-01-05 08:00 UTC"
    assert when("2011-03-02T02:56:54") == "2011-03-02 02:56"
    assert when("2026-01-05T08:00:00+02:00") == "2026-01-05 08:00 +0200"
    assert when("spring 2019") == "spring 2019"
    assert when("2019-04-01") == "2019-04-01"
    assert when(None) is None


def test_percent_and_rounding_keep_the_digits_that_matter():
    assert percent(0.00021, sign=True) == "+0.02 %"
    assert percent(-0.00021, sign=True) == "−0.02 %"
    assert percent(0.0, sign=True) == "0.00 %"
    assert rounded(240_649.0, 3) == 241_000.0
    assert rounded(-0.012345, 2) == -0.012


def test_a_ratio_carries_a_multiplication_sign_and_a_plain_number_no_unit():
    def row(**kwargs):
        return verdict_row(gonio.Verdict(title="t", verdict="pass", sentence="s", **kwargs))

    ratio = row(id="dynamic_range", value=240_649.0, unit="1")
    assert (ratio["value"], ratio["unit"]) == ("241\u202f000", "×")
    plain = row(id="energy", value=0.47829, unit="1")
    assert (plain["value"], plain["unit"]) == ("0.478", "")


def test_the_head_names_instrument_and_time_and_falls_back_on_the_file_name():
    provenance = {
        "instrument": "arm 3",
        "started": "2026-01-05T08:00:00Z",
        "inputs": [{"name": "black_A.xls", "role": "sample"}, {"name": "blank.xls", "role": "dark"}],
    }
    measured = samples.measurement([samples.make_slice()], sample_name=None, provenance=provenance)
    head = describe(measured, [], title=None, drawn=[])
    assert head["title"] == "black_A"
    assert ("Instrument", "arm 3") in head["facts"]
    assert ("Measured", "2026-01-05 08:00 UTC") in head["facts"]


def test_settings_that_were_not_set_are_named_in_one_line(tmp_path):
    provenance = {"settings": {"align": True, "upphi": None, "format": None}}
    page = page_of([samples.make_slice()], tmp_path, provenance=provenance)
    assert "align yes not set upphi, format" in page.words


def test_the_hemispherical_truth_stands_beside_the_measured_value(tmp_path):
    campaign = gonio.simulate(material="lambert", incidences=[(30.0, 0.0)], out=tmp_path / "raw")
    made = samples.make_slice(back=False)  # 0.9812 ± 0.0041
    path = render_report(
        samples.measurement([made]), [], out=tmp_path / "r.html", truth=campaign.material.bsdf
    )
    page = Page(path.read_text(encoding="utf-8"))
    albedo = campaign.material.directional_hemispherical(theta_i=30.0, phi_i=0.0, side="front")
    (integral,) = page.data["gonio-data"]["slices"][0]["integrals"]
    assert integral["truth"] == pytest.approx(albedo)
    assert f"{albedo:.4f} {percent(0.9812 / albedo - 1.0, sign=True)}" in page.words
    assert "Truth Difference" in page.words


def test_a_measurement_keeps_the_instrument_and_the_start_of_its_files(tmp_path):
    campaign = gonio.simulate(material="lambert", incidences=[(10.0, 0.0)], out=tmp_path / "raw")
    measured = gonio.process(campaign.sample, beam=campaign.beam, dark=campaign.dark)
    assert measured.provenance["instrument"] == "gonio virtual goniophotometer"
    assert measured.provenance["started"] == "2026-01-05T08:00:00Z"


def test_a_map_of_distinct_directions_is_not_called_thinned(tmp_path):
    theta, phi = samples.grid(back=False)
    made = samples.make_slice(theta_s=[*theta, 12.0], phi_s=[*phi, 0.0])  # one direction read twice
    page = page_of([made], tmp_path)
    assert "The others repeat a direction or are not usable." in page.words
    assert "fewer where neighbours agree" not in page.words
