"""Readers and writers of text files as Python sees them: errors, options, round trips."""

import os

import gonio
import numpy as np
import pytest
from gonio import _native
from hypothesis import given, settings
from hypothesis import strategies as st

HEAD = "#format: theta phi BSDF\n#incident_angle 30 0\n#upphi 90\n"


def write(folder, text, name="a.txt"):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "0 bytes"),
        (f"{HEAD}10 20\n", "line 4: row: found 2 columns"),
        (f"{HEAD}10 20 3 4\n", "line 4"),
        (f"{HEAD}200 20 3\n", "line 4: theta: found 200"),
        (HEAD, "readings"),
        (f"{HEAD}#datapoints_in_file 2\n1 2 3\n", "truncated"),
        (HEAD.encode() + b"1 2 \xff\x00\n", "line 4"),
        (b"\x7fELF\x00\x00", "no format"),
    ],
)
def test_bad_files_are_one_clear_error(tmp_path, content, message):
    path = write(tmp_path, content)
    with pytest.raises(gonio.FormatError, match=message) as error:
        gonio.read(path)
    assert str(path) in str(error.value)
    assert len(str(error.value)) < 600


def test_a_line_of_200_mb_is_refused_without_reading_it_all(tmp_path):
    path = tmp_path / "long.txt"
    with path.open("wb") as file:
        file.write(HEAD.encode() + b"1 2 3\n")
        file.seek(200_000_000)
        file.write(b"1")
    with pytest.raises(gonio.FormatError, match="line 5"):
        gonio.read(path)


def test_refusals_of_the_system_keep_their_python_class(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"missing\.txt"):
        _native.read_file(tmp_path / "missing.txt")
    with pytest.raises(IsADirectoryError):
        _native.read_file(tmp_path)
    if os.geteuid() != 0:
        path = write(tmp_path, HEAD)
        path.chmod(0)
        with pytest.raises(PermissionError):
            _native.read_file(path)


def test_a_table_is_read_with_mapped_columns(tmp_path):
    path = write(tmp_path, "aoi;view;x\n10;-5;0.5\n10;5;0.25\n", "t.csv")
    columns = {"theta_i": "aoi", "theta_s": "view", "value": "x", "phi_i": "180", "phi_s": "0"}
    with pytest.raises(gonio.FormatError, match="quantity"):
        gonio.read(path, columns=columns, channel="532nm")
    (scan,) = gonio.read(path, columns=columns, channel="532nm", quantity="reflectance_factor")
    assert scan.channel == "532nm"
    np.testing.assert_allclose(scan.phi_s, [180, 0], atol=1e-12)


def test_writing_into_a_missing_folder_leaves_nothing(tmp_path):
    scan = gonio.read(write(tmp_path, HEAD + "1 2 3\n"))[0]
    with pytest.raises(FileNotFoundError):
        _native.write_raw(tmp_path / "none" / "a.txt", [scan])
    with pytest.raises(IsADirectoryError):
        _native.write_mountain(tmp_path, scan)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.txt"]


finite = st.floats(allow_nan=False, allow_infinity=False, width=64)
readings = st.lists(st.tuples(st.floats(0, 180), st.floats(0, 359.999), finite), min_size=1, max_size=30)


@settings(max_examples=60, deadline=None)
@given(readings, st.sampled_from(["signal", "bsdf", "dsf"]), st.floats(0, 180), st.floats(0, 359.999))
def test_scans_return_from_both_text_formats(tmp_path_factory, rows, quantity, theta_i, phi_i):
    theta_s, phi_s, value = np.array(rows).T
    scan = _native.Scan(
        quantity=quantity, theta_i=theta_i, phi_i=phi_i, theta_s=theta_s, phi_s=phi_s, value=value
    )
    folder = tmp_path_factory.mktemp("text")
    _native.write_mountain(folder / "m.txt", scan)
    _native.write_raw(folder / "r.txt", [scan])
    for name in ("m.txt", "r.txt"):
        (back,) = _native.read_file(folder / name)
        assert (back.quantity, back.channel, back.kind) == (quantity, "photopic", "sample")
        np.testing.assert_array_equal(back.theta_s, scan.theta_s)
        np.testing.assert_array_equal(back.phi_s, scan.phi_s)
        np.testing.assert_array_equal(back.value, value)
        assert (back.theta_i, back.phi_i) == (scan.theta_i, scan.phi_i)


@settings(max_examples=200, deadline=None)
@given(
    st.sampled_from(["", HEAD, "#gonio raw 1\n", "theta_i,phi_i,theta_s,phi_s,value\n"]),
    st.binary(max_size=300),
)
def test_any_bytes_give_readings_or_a_format_error(tmp_path_factory, head, tail):
    path = tmp_path_factory.getbasetemp() / "any.txt"
    path.write_bytes(head.encode() + tail)
    for name in ("mountain", "gonio-raw", "nist-ptfe", "table", None):
        try:
            scans = _native.read_file(path, name)
            message = str(path)
        except gonio.FormatError as error:
            scans, message = [], str(error)
        assert str(path) in message
        assert all(len(s) > 0 for s in scans)
