"""Radiance materials across the seam: text in, text out, models with a value a channel."""

import gonio
import numpy as np
import pytest
from gonio.materials import radiance

TEXT = """# a library
void plastic paint
0
0
5 .8 .4 .2 .02 .1
grain metal2 brushed 4 0 1 0 . 0 6 .9 .8 .7 .9 .05 .2
void alias paint_too paint
void polygon wall 0 0 9 0 0 0 1 0 0 1 1 0
void glass pane 0 0 3 .96 .96 .96
"""


def test_materials_are_read_by_name_and_written_back_the_same(tmp_path):
    path = tmp_path / "a.rad"
    path.write_text(TEXT)
    materials = gonio.read_materials(path)
    assert [(m.id, m.type, m.modifier, m.line) for m in materials] == [
        ("paint", "plastic", "void", 2),
        ("brushed", "metal2", "grain", 6),
        ("paint_too", "plastic", "void", 7),
        ("pane", "glass", "void", 9),
    ]
    assert materials[0].parameters == {"red": 0.8, "green": 0.4, "blue": 0.2, "spec": 0.02, "rough": 0.1}
    assert materials[1].strings == ["0", "1", "0", "."]
    assert list(materials[3].parameters) == ["rtn", "gtn", "btn"]
    copy = tmp_path / "b.rad"
    gonio.write_materials(copy, materials, comment="two lines\nof comment")
    assert copy.read_text().startswith("# two lines\n# of comment\n\nvoid plastic paint\n0\n0\n5 0.8")
    assert [m.parameters for m in gonio.read_materials(copy)] == [m.parameters for m in materials]


def test_a_material_made_of_its_parameters_is_the_one_its_text_reads_back_as(tmp_path):
    made = gonio.RadianceMaterial(
        "trans", id="t", red=0.9, green=0.9, blue=0.9, spec=0.05, rough=0.1, trans=0.5, tspec=0.2
    )
    gonio.write_materials(tmp_path / "t.rad", made)
    assert (tmp_path / "t.rad").read_text() == made.text
    (again,) = gonio.read_materials(tmp_path / "t.rad")
    assert (again.type, again.parameters) == (made.type, made.parameters)
    oval = gonio.RadianceMaterial("plastic2", id="p", red=1, green=1, blue=1, spec=0, urough=0.1, vrough=0.2)
    assert oval.strings == ["1", "0", "0", "."]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"type": "wood"}, r'type: found "wood", allowed plastic, metal'),
        ({"spec": None}, "spec: found nothing, allowed 0 to 1"),
        ({"rough": 2.0}, "rough: found 2, allowed 0 to 1"),
        ({"gloss": 2.0}, "plastic: found parameter gloss, allowed red, green, blue, spec, rough"),
        ({"strings": ["a"]}, "string arguments: found 1, allowed 0"),
        ({"id": ""}, 'id: found "", allowed a name without tabs and line ends'),
    ],
)
def test_parameters_that_make_no_material_are_named(arguments, message):
    whole = {"type": "plastic", "id": "p", "red": 0.5, "green": 0.5, "blue": 0.5, "spec": 0.1, "rough": 0.1}
    given = {k: v for k, v in (whole | arguments).items() if v is not None}
    with pytest.raises(gonio.DomainError, match=message):
        gonio.RadianceMaterial(given.pop("type"), **given)


def test_a_material_is_a_model_of_three_channels():
    model = radiance("void plastic p 0 0 5 .8 .4 .2 0 0")
    assert model.channels == ["red", "green", "blue"]
    for channel, albedo in zip(model.channels, (0.8, 0.4, 0.2), strict=True):
        f = model.eval(theta_i=20, phi_i=0, theta_s=[10.0, 70.0, 110.0], phi_s=50, channel=channel)
        np.testing.assert_allclose(f, [albedo / np.pi, albedo / np.pi, 0.0], rtol=1e-12)
    with pytest.raises(gonio.QuantityError, match="found none, needed one of red, green, blue"):
        model.eval(theta_i=20, phi_i=0, theta_s=10, phi_s=50)


def test_the_ideal_part_tells_where_light_goes_and_how_much_of_it():
    pane = radiance("void glass g 0 0 3 .96 .96 .96")
    through = pane.delta(theta_i=[0.0, 60.0, 90.0], phi_i=30, component="transmission", channel="red")
    assert through["share"][0] == pytest.approx(0.88, abs=2e-3)
    np.testing.assert_allclose(through["theta_s"][:2], [180.0, 120.0])
    u = np.random.default_rng(1).random((20_000, 3))
    drawn = pane.sample(theta_i=60, phi_i=30, u=u)
    assert drawn["ideal"].all()
    mirrored = pane.delta(theta_i=60.0, phi_i=30, component="reflection", channel="red")
    assert drawn["weight"].mean() == pytest.approx(mirrored["share"] + through["share"][1], rel=0.02)
    body = radiance("void dielectric d 0 0 5 1 1 1 1.5 0")
    inside = body.delta(theta_i=30.0, phi_i=0, component="transmission", channel="blue")
    assert np.sin(np.radians(inside["theta_s"])) == pytest.approx(0.5 / 1.5)
    beyond = body.delta(theta_i=130.0, phi_i=0, component="transmission", channel="blue")
    assert np.isnan(beyond["theta_s"])
    assert beyond["share"] == 0.0


def test_a_modifier_is_not_left_out_in_silence():
    with pytest.raises(gonio.DomainError, match=r'modifier: found "grain" of "p"'):
        radiance("grain plastic p 0 0 5 .8 .4 .2 0 0")
    assert radiance("grain plastic p 0 0 5 .8 .4 .2 0 0", ignore_modifier=True).channels


def test_commands_and_texts_without_one_material_are_refused(tmp_path):
    path = tmp_path / "a.rad"
    mark = tmp_path / "ran"
    path.write_text(f"!touch {mark}\n")
    with pytest.raises(gonio.FormatError, match=r'a.rad, line 1: command: found "!touch '):
        gonio.read_materials(path)
    assert not mark.exists()
    with pytest.raises(gonio.DomainError, match=r"text: found 0 materials \(none\), allowed one"):
        radiance("")
    with pytest.raises(gonio.DomainError, match=r'release: found "5", allowed 6.0, 6.1'):
        radiance("void mirror m 0 0 3 1 1 1", release="5")
    with pytest.raises(FileNotFoundError):
        gonio.read_materials(tmp_path / "none.rad")


def test_an_ideal_part_is_exported_to_its_patches_and_kept_in_a_compact_model(tmp_path):
    mirror = radiance("void metal m 0 0 5 .9 .9 .9 .9 0")
    gonio.export(mirror, to="radiance-klems", channel="red", as_visible=True, out=tmp_path / "m.xml")
    klems = gonio.read_radiance(tmp_path / "m.xml")
    share = gonio._native.directional_albedo(klems, theta_i=0, phi_i=0, component="reflection")
    assert share == pytest.approx(0.9, abs=0.005)
    reduced = gonio.reduce(mirror, channels=["red"]).model
    at = {"theta_i": [0.0, 35.0, 70.0], "phi_i": 0.0, "component": "reflection", "channel": "red"}
    np.testing.assert_allclose(reduced.delta(**at)["share"], mirror.delta(**at)["share"], atol=0.005)


@pytest.mark.parametrize("to", ["radiance-klems", "radiance-ttree"])
def test_the_loss_of_an_export_tells_unscattered_light_from_scattered(tmp_path, to):
    curtain = radiance("void trans c 0 0 7 .8 .8 .8 0 0 .6 .5")
    out = tmp_path / "c.xml"
    written = gonio.export(curtain, to=to, channel="green", as_visible=True, out=out)
    for loss in (written.report["loss"][s, "transmission"] for s in ("front", "back")):
        assert loss["ideal_model"] == pytest.approx(0.24, rel=1e-9)
        assert loss["ideal"] == pytest.approx(0.24, rel=0.01)
        assert abs(loss["ideal_difference"]) < 0.003
        assert loss["rel_l1_max"] < 0.01
        assert loss["peak_ratio"] == pytest.approx(1, abs=0.01)
        assert abs(loss["dhr_difference"]) < 0.003
    assert not any("relative L1" in note for note in written.warnings)
    table = gonio.read_radiance(out)
    checked = {v.id: v.value for v in gonio.check_model(table)}
    assert checked["energy"] == pytest.approx(written.report["max_albedo"], rel=1e-5)
    printed = [loss["reciprocity"] for loss in written.report["loss"].values()]
    assert checked["reciprocity"] == pytest.approx(max(printed), rel=1e-3, abs=1e-6)
    for theta_i in (0.0, 14.4, 40.0, 150.0):
        for pair in ((curtain, table), (table, curtain)):
            names = {"channel_a": pair[0].channels[-2:][0], "channel_b": pair[1].channels[-2:][0]}
            at = {"theta_i": theta_i, "phi_i": 10.0, "component": "transmission"}
            row = gonio._native.compare_models(*pair, **at, **names)
            assert row["ideal_a"] == pytest.approx(0.24, rel=0.02)
            assert row["ideal_b"] == pytest.approx(0.24, rel=0.02)
            assert row["albedo_a"] == pytest.approx(row["albedo_b"], rel=0.01)
            assert row["rel_l1"] < 0.01


def test_two_models_with_unscattered_light_are_compared_in_it():
    curtain, clearer = (radiance(f"void trans c 0 0 7 .8 .8 .8 0 0 .6 {t}") for t in (0.5, 0.6))
    found = gonio.compare(curtain, clearer, channel="green", components=[("front", "transmission")])
    assert found.warnings == []
    for row in found.rows:
        assert (row.ideal_a, row.ideal_b) == pytest.approx((0.24, 0.288))
        assert row.rel_l1 == pytest.approx(0.2)
        assert (row.dhr_a, row.dhr_b) == pytest.approx((0.48, 0.48), rel=1e-3)
    pane = radiance("void glass g 0 0 3 .9 .9 .9")
    found = gonio.compare(pane, pane, channel="red")
    assert {(r.side, r.component) for r in found.rows} == set(gonio.comparing.KEYS)
    assert all(row.ideal_a == row.ideal_b > 0.05 for row in found.rows)
