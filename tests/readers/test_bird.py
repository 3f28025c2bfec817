"""JSON of the project BiRD, read and written."""

import json

import gonio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.cli.test_build import lambertian


def document(**changes):
    """Two wavelengths at two incidences with two directions each; a change of None removes a variable."""
    data = {
        "theta_i": {"unit": "°", "values": [0, 0, 30, 30, 0, 0, 30, 30]},
        "phi_i": {"unit": "deg", "values": [0] * 8},
        "theta_r": {"unit": "rad", "values": [0.5, 0.25] * 4},
        "phi_r": {"unit": "deg", "values": [180, 90] * 4},
        "wavelength_i": {"unit": "μm", "values": [0.55] * 4 + [0.65] * 4},
        "BRDF": {"unit": "sr^-1", "values": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8]},
    }
    data.update(changes)
    return {
        "metadata": {
            "sample": {"name": "SRT1"},
            "instrumentation": "NA",
            "timestamp": "2022-01-14T12:00:00+02",
        },
        "data": {name: v for name, v in data.items() if v is not None},
    }


def write(folder, content):
    path = folder / "a.brdf"
    path.write_text(content if isinstance(content, str) else json.dumps(content, ensure_ascii=False))
    return path


def test_one_scan_an_incidence_and_wavelength_in_the_units_of_gonio(tmp_path):
    readings = gonio.read(write(tmp_path, document()))
    assert [(s.channel, s.theta_i) for s in readings] == [
        ("550nm", 0.0),
        ("550nm", 30.0),
        ("650nm", 0.0),
        ("650nm", 30.0),
    ]
    scan = readings[3]
    assert (scan.quantity, scan.meta["sample_name"]) == ("bsdf", "SRT1")
    np.testing.assert_allclose(scan.theta_s, np.degrees([0.5, 0.25]))
    np.testing.assert_array_equal(scan.value, [0.7, 0.8])
    assert len(gonio.read(write(tmp_path, document()), channel="650nm")) == 2


def test_the_older_layout_of_rows_is_read_alike(tmp_path):
    new = document()
    names = list(new["data"])
    old = {
        "metadata": new["metadata"],
        "data": {
            "variables": [{"name": n, "type": "number", "unit": new["data"][n]["unit"]} for n in names],
            "values": [list(row) for row in zip(*(new["data"][n]["values"] for n in names), strict=True)],
        },
    }
    first = gonio.read(write(tmp_path, new))
    second = gonio.read(write(tmp_path, old))
    for a, b in zip(first, second, strict=True):
        assert (a.channel, a.theta_i, a.phi_i) == (b.channel, b.theta_i, b.phi_i)
        np.testing.assert_array_equal(a.value, b.value)
    old["data"]["values"][2].pop()
    with pytest.raises(gonio.FormatError, match="row 3 of values: found 5 columns, allowed 6"):
        gonio.read(write(tmp_path, old))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"theta_i": None}, "theta_i: found no values"),
        ({"BRDF": {"unit": "1/sr", "values": [1]}}, "theta_i: found 8 values, allowed 1"),
        ({"BRDF": {"unit": "%", "values": [1] * 8}}, "BRDF: found unit '%', allowed 1/sr"),
        ({"theta_r": {"unit": "deg", "values": [95] * 8}}, "theta_r of value 1: found 95.0, allowed 0 to 90"),
        ({"phi_r": {"unit": "deg", "values": ["x"] * 8}}, "phi_r: found a value that is no number"),
        ({"polarization_i": {"values": ["s", "p"] * 4}}, 'polarization_i: found "s", "p", allowed one value'),
        ({"wavelength_r": {"unit": "nm", "values": [500] * 8}}, "wavelength_r: found others than"),
    ],
)
def test_faults_are_told_by_variable(tmp_path, change, message):
    with pytest.raises(gonio.FormatError) as error:
        gonio.read(write(tmp_path, document(**change)))
    assert message in str(error.value)


def test_other_json_and_missing_statements_are_refused(tmp_path):
    with pytest.raises(gonio.FormatError, match="line 2: JSON: found"):
        gonio.read(write(tmp_path, '{"metadata": {},\n "data": {,}}'))
    with pytest.raises(gonio.FormatError, match="no objects metadata and data"):
        gonio.read(write(tmp_path, "{}"))
    grey = write(tmp_path, document(wavelength_i=None))
    with pytest.raises(gonio.QuantityError, match="channel: found no wavelength"):
        gonio.read(grey)
    assert len(gonio.read(grey, channel="photopic")) == 2
    with pytest.raises(gonio.QuantityError, match="quantity: found dsf"):
        gonio.read(grey, quantity="dsf")


@settings(max_examples=200, deadline=None)
@given(st.recursive(st.none() | st.floats() | st.text(max_size=3), lambda x: st.lists(x, max_size=3)))
def test_no_values_break_the_reader(tmp_path_factory, values):
    folder = tmp_path_factory.mktemp("bird")
    content = document(theta_r={"unit": "deg", "values": values})
    with pytest.raises(gonio.GonioError):
        gonio.read(write(folder, content))


def test_a_measurement_survives_the_file(tmp_path):
    measurement = gonio.process([lambertian(t) for t in (0, 40)], out=tmp_path / "m")
    written = gonio.export(tmp_path / "m", to="bird-json", out=tmp_path / "a.brdf")
    assert "has no place in the format" in written.warnings[0]
    content = json.loads((tmp_path / "a.brdf").read_text(encoding="utf-8"))
    assert content["metadata"]["type"] == "BRDF"
    assert len(content["data"]["uBRDF"]["values"]) == len(content["data"]["BRDF"]["values"])
    readings = gonio.read(tmp_path / "a.brdf", channel="photopic")
    assert [s.theta_i for s in readings] == [s.theta_i for s in measurement.slices]
    for scan, part in zip(readings, measurement.slices, strict=True):
        inside = part.theta_s < 89.9
        np.testing.assert_allclose(scan.value, part.bsdf[inside], rtol=1e-14)
        np.testing.assert_allclose(scan.theta_s, part.theta_s[inside], rtol=1e-14)
