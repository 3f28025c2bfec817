"""The HTML report: complete in itself, safe, and whole for every kind of measurement."""

import base64
import json
import re
from html.parser import HTMLParser

import gonio
import numpy as np
import pytest
from gonio.reporting.compare import Reference, residual_rows
from gonio.reporting.drawn import draw
from gonio.reporting.page import render_report

from . import samples

VOID = {"area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "track", "wbr"}
CASES = samples.cases()


class Page(HTMLParser):
    """Elements, attributes and text of a page; fails on an end tag that closes nothing."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.elements, self.problems, self.text, self.ids, self.data = [], [], [], [], [], {}
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        attributes = dict(attrs)
        self.elements.append((tag, attributes))
        if "id" in attributes:
            self.ids.append(attributes["id"])
        if tag not in VOID:
            self.open.append((tag, attributes))

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        if not self.open or self.open[-1][0] != tag:
            self.problems.append(f"</{tag}> closes {self.open[-1:]}")
        else:
            self.open.pop()

    def handle_data(self, data):
        tag, attributes = self.open[-1] if self.open else ("", {})
        if tag == "script":
            if attributes.get("type") == "application/json":
                self.data[attributes["id"]] = json.loads(data)
        elif tag != "style":
            self.text.append(data)

    @property
    def words(self):
        return " ".join(" ".join(self.text).split())


def page_of(slices, tmp_path, **kwargs):
    measurement_kwargs = {k: kwargs.pop(k) for k in ("sample_name", "provenance", "warnings") if k in kwargs}
    path = render_report(
        samples.measurement(slices, **measurement_kwargs),
        kwargs.pop("verdicts", samples.verdicts()),
        out=tmp_path / "report.html",
        **kwargs,
    )
    return Page(path.read_text(encoding="utf-8"))


def array(text, kind="<f4"):
    return np.frombuffer(base64.b64decode(text), dtype=kind)


@pytest.mark.parametrize("name", CASES)
def test_every_kind_of_measurement_gives_a_well_formed_page_with_every_verdict(name, tmp_path):
    page = page_of(CASES[name], tmp_path)
    assert page.problems == []
    assert page.open == []
    assert len(page.ids) == len(set(page.ids))
    for verdict in samples.verdicts():
        assert verdict.sentence in page.words
        assert verdict.title in page.words
    assert len(page.data["gonio-data"]["slices"]) == len(CASES[name])


def test_the_page_loads_nothing_from_anywhere(tmp_path):
    page = page_of([samples.make_slice()], tmp_path)
    for tag, attributes in page.elements:
        for name in ("src", "href", "action", "data", "poster", "srcset"):
            value = attributes.get(name) or ""
            assert not value or value.startswith(("#", "data:")), (tag, name, value)
        assert "@import" not in (attributes.get("style") or "")
    policy = next(a["content"] for t, a in page.elements if t == "meta" and a.get("http-equiv"))
    assert "default-src 'none'" in policy
    assert "http" not in policy


def test_the_style_and_the_scripts_of_the_page_name_no_address(tmp_path):
    path = render_report(samples.measurement([samples.make_slice()]), [], out=tmp_path / "r.html")
    text = path.read_text(encoding="utf-8")
    style = text[text.index("<style>") : text.index("</style>")]
    own = text[text.rindex("<script>") :]
    assert not re.search(r"https?://|url\(|@import", style + own)


@pytest.mark.parametrize(
    "hostile",
    [
        "<script>alert(1)</script>",
        '"><img src=x onerror=alert(1)>',
        "</title><b>",
        "</script><script>alert(1)//",
        "a & b <i>'",
    ],
)
def test_a_hostile_name_is_shown_as_text(hostile, tmp_path):
    plain = page_of([samples.make_slice()], tmp_path)
    verdict = gonio.Verdict(
        id=hostile, title=hostile, verdict="warn", sentence=hostile, value=1.0, unit=hostile
    )
    page = page_of(
        [samples.make_slice()],
        tmp_path,
        sample_name=hostile,
        verdicts=[*samples.verdicts(), verdict],
        warnings=[hostile],
        provenance={hostile: hostile, "files": [{"path": hostile}], "instrument": hostile},
        title=hostile,
    )
    assert page.problems == []
    count = lambda p, tag: sum(t == tag for t, _ in p.elements)  # noqa: E731
    for tag in ("script", "img", "b", "i"):
        assert count(page, tag) == count(plain, tag)
    assert not any(name.startswith("on") for _, attributes in page.elements for name in attributes)
    assert " ".join(hostile.split()) in page.words


def test_the_integrals_are_written_with_their_expanded_uncertainty(tmp_path):
    page = page_of([samples.make_slice(back=False)], tmp_path)
    assert "0.9812 ± 0.0041" in page.words
    assert "1.25 %" in page.words  # 0.0123 / 0.9812 extrapolated


def test_the_summary_names_what_fails_and_what_needs_a_look(tmp_path):
    page = page_of([samples.make_slice()], tmp_path)
    assert "1 of 3 checks pass; “Copies” fails; “Grazing gap” needs a look." in page.words


def test_a_large_measurement_is_thinned_without_losing_its_peak(tmp_path):
    rng = np.random.default_rng(3)
    z, phi = rng.uniform(0.05, 1.0, 60_000), rng.uniform(0.0, 360.0, 60_000)
    theta = np.degrees(np.arccos(z))
    dsf = samples.lobe(30.0, 0.0, theta, phi)
    dsf[41_234] = 77.0
    page = page_of([samples.make_slice(theta_s=theta, phi_s=phi, dsf=dsf)], tmp_path)
    side = page.data["gonio-data"]["slices"][0]["sides"][0]
    assert side["n"] < 10_000
    assert array(side["dsf"]).max() == pytest.approx(77.0)
    assert f"draw {side['n']:,} of 60,000 readings".replace(",", "\u202f") in " ".join(page.text)


def test_a_reference_is_drawn_and_its_residuals_are_listed(tmp_path):
    class Known:
        channels = ("photopic",)

        def eval(self, *, theta_i, phi_i, theta_s, phi_s, channel=None):
            assert channel == "photopic"
            return samples.lobe(theta_i, phi_i, theta_s, phi_s) / np.abs(np.cos(np.radians(theta_s))) / 1.02

    page = page_of([samples.make_slice()], tmp_path, truth=Known())
    assert "Residuals against the known truth" in page.words
    assert "2.00 %" in page.words
    profile = page.data["gonio-data"]["slices"][0]["profile"]
    drawn = array(profile["references"]["truth"])
    assert drawn.shape == array(profile["x"]).shape
    mirror = np.nanargmin(np.abs(array(profile["x"]) - 30.0))
    assert drawn[mirror] == pytest.approx(array(profile["y"])[mirror] / 1.02, rel=0.02)


def test_residuals_count_every_reading():
    rng = np.random.default_rng(4)
    theta_s, phi_s = np.degrees(np.arccos(rng.uniform(0.2, 1.0, 30_001))), rng.uniform(0.0, 360.0, 30_001)
    drawn = draw(samples.make_slice(theta_s=theta_s, phi_s=phi_s), 0, 500)

    class Known:
        channels = ("photopic",)

        def eval(self, *, theta_i, phi_i, theta_s, phi_s, channel=None):
            return samples.lobe(theta_i, phi_i, theta_s, phi_s) / np.abs(np.cos(np.radians(theta_s)))

    (row,) = residual_rows([drawn], [Reference(name="truth", label="truth", bsdf=Known())])
    assert row["n"] == "30\u202f001"


def test_a_failed_write_leaves_the_old_report_and_nothing_else(tmp_path, monkeypatch):
    out = tmp_path / "report.html"
    out.write_text("old")
    monkeypatch.setattr(
        "pathlib.Path.write_text", lambda *a, **k: (_ for _ in ()).throw(OSError(28, "disk full"))
    )
    with pytest.raises(OSError, match=r"No space left on device.*report.html"):
        render_report(samples.measurement([samples.make_slice()]), [], out=out)
    assert out.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [out]


def test_the_page_of_a_campaign_stays_small(tmp_path):
    slices = [samples.make_slice(t, channel=c) for t in range(0, 80, 5) for c in ("red", "green", "blue")]
    path = render_report(samples.measurement(slices), samples.verdicts(), out=tmp_path / "r.html")
    assert path.stat().st_size < 12e6


def test_nested_provenance_is_laid_out_as_tables(tmp_path):
    provenance = {"processing": {"dark": [{"method": "time", "mean": 2.0335613}], "mode": {"deep": [1, 2]}}}
    page = page_of([samples.make_slice()], tmp_path, provenance=provenance)
    assert "Processing: dark" in page.words
    assert "2.03356" in page.words
    assert "mode / deep 1, 2" in page.words
    assert "{" not in page.words
