"""The page of a fit and the fitted model in the report."""

import base64
import io
import re

import gonio
import numpy as np
import pytest
from gonio.fit_outputs import save_fit
from gonio.materials import material
from gonio.reporting import fit_figures
from gonio.reporting.fit_figures import LIMITS, limit_of, relative_residuals
from matplotlib.image import imread


@pytest.fixture(scope="module")
def measured():
    return gonio.tabulate(
        material("trans").bsdf,
        incidences=[(15, 0), (50, 0)],
        components=["reflection", "transmission"],
        pitch=10,
        peak_pitch=2,
        sample_name="<panel> & co",
    )


@pytest.fixture(scope="module")
def page(measured, tmp_path_factory):
    directory = tmp_path_factory.mktemp("fit") / "f"
    found = gonio.fit(measured, models=["trans", "lambert+lambert-transmission"])
    save_fit(found, out=directory, measurement=measured)
    return found, (directory / "residuals.html").read_text(encoding="utf-8")


def test_the_page_is_complete_in_itself_and_runs_no_script(page):
    text = page[1]
    assert "://" not in re.sub(r"data:image/png;base64,[\w+/=]+", "", text)
    assert "<script" not in text
    assert "<panel>" not in text
    assert "&lt;panel&gt; &amp; co" in text


def test_every_parameter_model_and_residual_has_its_row(page):
    found, text = page
    for e in found.estimates:
        assert f'<th scope="row">{e.name}</th>' in text
    for f in found.ranking.fits:
        name = f.model.replace("+", "+\u200b")
        assert f'<th scope="row">{name}<' in text
    assert len(re.findall(r"<tr><td class=\"num\">", text)) == len(found.residuals) == 4


def test_a_sample_without_a_name_has_that_of_its_directory(tmp_path):
    sample = gonio.tabulate(
        material("lambert").bsdf, incidences=[(15, 0), (50, 0)], pitch=20, sample_name=None
    )
    sample.save(tmp_path / "panel_7")
    save_fit(
        gonio.fit(tmp_path / "panel_7", model="lambert"), out=tmp_path / "f", measurement=tmp_path / "panel_7"
    )
    assert "<h1>panel_7</h1>" in (tmp_path / "f" / "residuals.html").read_text(encoding="utf-8")


def test_the_errors_are_labelled_with_plain_numbers(page, monkeypatch):
    drawn = []
    monkeypatch.setattr(fit_figures, "_png", drawn.append)
    fit_figures.errors_figure(page[0].ranking.fits)
    figure = drawn[0]
    figure.draw_without_rendering()
    axis = figure.axes[0].yaxis
    labels = [
        t.get_text() for t in (*axis.get_majorticklabels(), *axis.get_minorticklabels()) if t.get_text()
    ]
    assert labels
    for label in labels:
        assert float(label) > 0.0
        assert "e" not in label or float(label) < 1e-4


def test_the_page_tells_which_models_can_be_written(page):
    rows = re.findall(r'<tr><th scope="row">([^<]+)<.*?</tr>', page[1])
    assert len(rows) > 2
    assert re.search(r'<th scope="row">trans<.*?<td>Radiance</td>', page[1])


def test_printed_tables_are_whole(page):
    """Paper does not scroll: the box that does on the screen has neither a height nor an edge there."""
    style = re.search(r"<style>(.*)</style>", page[1], re.S).group(1)
    on_paper = style[style.rindex("@media print") :]
    assert re.search(r"\.scroll \{ max-height: none; overflow: visible; \}", on_paper)
    assert ".numbers thead th, .numbers td:not(.num), .plain td { white-space: normal; }" in on_paper


def test_every_slice_has_a_picture_and_so_have_the_errors(page):
    pictures = re.findall(r"data:image/png;base64,([\w+/=]+)", page[1])
    assert len(pictures) == 2 + 1
    for picture in pictures:
        pixels = imread(io.BytesIO(base64.b64decode(picture)), format="png")
        assert pixels.shape[0] > 200
        assert pixels.std() > 0.05


def test_residuals_are_relative_and_bounded_by_the_noise():
    s = gonio.Slice(
        theta_i=0,
        phi_i=0,
        channel="photopic",
        theta_s=[0, 10, 20, 30],
        phi_s=[0, 0, 0, 0],
        dsf=[1.0, 0.001, 1.0, 1.0],
        u_dsf=[0.01, 0.05, 0.01, 0.01],
        omega=[1, 1, 1, 1],
        flags=np.array([0, 0, gonio.FLAGS["shadow"], 0], np.uint16),
    )
    got = relative_residuals(s, np.array([1.1, 0.051, 2.0, np.nan]))
    np.testing.assert_allclose(got, [0.1, 0.5, np.nan, np.nan])
    assert limit_of([np.array([0.001])]) == LIMITS[0]
    assert limit_of([np.array([0.04, -0.04])]) == 0.05
    assert limit_of([np.array([7.0])]) == LIMITS[-1]
    assert limit_of([]) == LIMITS[0]


def test_many_slices_are_drawn_up_to_a_number_with_every_incidence(tmp_path):
    names = [f"{w}nm" for w in range(400, 700, 20)]
    model = gonio.analytic({"model": "lambert", "rho": {n: 0.1 + 0.01 * k for k, n in enumerate(names)}})
    sample = gonio.tabulate(model, incidences=[(10, 0), (60, 0)], pitch=20, peak_pitch=10)
    found = gonio.fit(sample, model="lambert", held_out=False)
    save_fit(found, out=tmp_path / "f", measurement=sample)
    text = (tmp_path / "f" / "residuals.html").read_text(encoding="utf-8")
    assert text.count('<figure class="slice">') == 24
    assert "The worst 24 of 30 slices are drawn" in text
    captions = re.findall(r"<h3>θi (\d+)°", text)
    assert set(captions) == {"10", "60"}


def test_the_report_draws_a_fitted_model_over_the_readings(measured, page, tmp_path):
    found = page[0]
    gonio.report(measured, out=tmp_path / "r.html", verdicts=[], model=found.bsdf())
    assert "Residuals against the model" in (tmp_path / "r.html").read_text(encoding="utf-8")
