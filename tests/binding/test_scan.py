import gonio
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

ANGLES = {"theta_i": 30.0, "phi_i": 0.0}


def scan(**changes):
    fields = {**ANGLES, "theta_s": [10.0, 20.0], "phi_s": [0.0, 90.0], "value": [1.0, 2.0], **changes}
    return gonio.Scan(**fields)


@given(
    theta=st.floats(0, 180),
    phi=st.floats(0, 360, exclude_max=True),
)
def test_degrees_survive_the_seam(theta, phi):
    s = scan(theta_i=theta, phi_i=phi, theta_s=[theta], phi_s=[phi], value=[1.0])
    for t, p in ((s.theta_i, s.phi_i), (s.theta_s[0], s.phi_s[0])):
        assert t == pytest.approx(theta, abs=1e-12)
        assert min(abs(p - phi), 360 - abs(p - phi)) < 1e-12


@given(
    theta=st.integers(0, 180 * 10**6),
    phi=st.integers(0, 360 * 10**6 - 1),
)
def test_decimal_degrees_survive_the_seam_bit_for_bit(theta, phi):
    theta, phi = theta / 10**6, phi / 10**6
    s = scan(theta_i=theta, phi_i=phi, theta_s=[theta], phi_s=[phi], value=[1.0])
    assert (s.theta_i, s.phi_i, s.theta_s[0], s.phi_s[0]) == (theta, phi, theta, phi)


def test_extended_polar_angles_lie_on_the_opposite_azimuth():
    s = scan(theta_i=-30, phi_i=0, theta_s=[-78.0, 190.0], phi_s=[0.0, 10.0])
    assert (s.theta_i, s.phi_i) == (30, 180)
    assert s.theta_s.tolist() == [78, 170]
    assert s.phi_s.tolist() == [180, 190]


def test_azimuths_come_back_canonical():
    assert scan(phi_s=[-90.0, 450.0]).phi_s == pytest.approx([270.0, 90.0])


def test_columns_of_any_numeric_type_and_layout_are_taken():
    s = scan(theta_s=np.arange(4, dtype=np.int32)[::2], phi_s=(0, 1), value=np.float32([1, 2]))
    assert s.theta_s == pytest.approx([0, 2])
    assert s.value.dtype == np.float64


def test_nan_readings_are_no_data_and_stay():
    assert np.isnan(scan(value=[np.nan, 1.0]).value[0])


def test_metadata_round_trips_and_unknown_fields_are_left_out():
    meta = {"sample_name": "PTFE", "distance": 1.2, "other": {"operator": "M."}}
    assert scan(meta=meta).meta == meta
    assert scan().meta == {}


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({"theta_i": 271.0}, ("theta_i", "271", "-180 to 270")),
        ({"theta_i": float("nan")}, ("theta_i", "NaN", "-180 to 270")),
        ({"phi_i": float("inf")}, ("phi_i", "inf", "-360 to 720")),
        ({"theta_s": [10.0, -181.0]}, ("theta_s of reading 2", "-181", "-180 to 270")),
        ({"value": [1.0]}, ("theta_s", "2 entries", "1, one a reading")),
        ({"kind": "lamp"}, ("kind", "lamp", "sample, beam, dark, standard")),
        ({"quantity": "watts"}, ("quantity", "watts", "signal")),
        ({"channel": "green-ish"}, ("channel", "green-ish", "532nm")),
        ({"meta": {"colour": "red"}}, ("meta", "colour", "sample_name")),
        ({"meta": {"distance": 0.0}}, ("distance", "0", "> 0")),
    ],
)
def test_a_value_out_of_range_is_named_with_what_is_allowed(changes, names):
    with pytest.raises(gonio.DomainError) as error:
        scan(**changes)
    for name in names:
        assert name in str(error.value)


def test_every_error_is_a_gonio_error():
    for error in (gonio.DomainError, gonio.FitError, gonio.FormatError, gonio.QuantityError):
        assert issubclass(error, gonio.GonioError)
