"""Files of other instruments: every spelling gives the same numbers, broken ones one clear error."""

import tempfile
from pathlib import Path

import gonio
import numpy as np
import pytest
import sdfio
from gonio.spectra import read_spectra
from gonio.surface_files import UNITS, read_surface
from gonio.text_numbers import read_numbers
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.instruments.surfaces import gaussian_map, gaussian_profile

numbers = st.floats(-1e6, 1e6, allow_nan=False).map(lambda v: float(f"{v:.6g}"))
tables = st.integers(2, 6).flatmap(
    lambda columns: st.lists(st.lists(numbers, min_size=columns, max_size=columns), min_size=1, max_size=12)
)


def read_text(text, encoding="utf-8", name="t.txt"):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / name
        path.write_bytes(text.encode(encoding))
        return read_numbers(path)


@given(
    rows=tables,
    separator=st.sampled_from([",", ";", "\t", " ", ", ", "; "]),
    end=st.sampled_from(["\n", "\r\n"]),
    comma=st.booleans(),
    header=st.sampled_from(["", "# measured today\n", "names\n", "# a\n\n% b\n{ c }\n"]),
    trailing=st.booleans(),
    encoding=st.sampled_from(["utf-8", "utf-8-sig", "utf-16", "latin-1"]),
)
@settings(max_examples=150, deadline=None)
def test_every_spelling_of_a_table_gives_its_numbers(rows, separator, end, comma, header, trailing, encoding):
    decimal = comma and "," not in separator
    text = header
    for row in rows:
        line = separator.join(repr(v) for v in row)
        line = line.replace(".", ",") if decimal else line
        text += line + (separator.strip() if trailing else "") + end
    table = read_text(text, encoding)
    np.testing.assert_array_equal(table.values, rows)


def message_of(read, path):
    """The message of the error that reading `path` ends in, or none."""
    try:
        read(path)
    except gonio.GonioError as error:
        return str(error)
    return None


@given(data=st.binary(max_size=400))
@settings(max_examples=300, deadline=None)
def test_no_bytes_end_in_anything_but_numbers_or_an_error_of_one_line(data):
    with tempfile.TemporaryDirectory() as folder:
        for name in ("t.txt", "t.npy", "t.sdf"):
            path = Path(folder) / name
            path.write_bytes(data)
            for read in (read_numbers, read_surface, read_spectra):
                message = message_of(read, path)
                assert message is None or (str(path) in message and len(message) < 400 + len(str(path)))


@given(
    form=st.sampled_from(["a.sdf", "b.sdf", "m.npy"]),
    at=st.floats(0, 1),
    junk=st.binary(max_size=12),
    cut=st.booleans(),
)
@settings(max_examples=300, deadline=None)
def test_a_damaged_surface_file_is_read_or_named(form, at, junk, cut):
    z = gaussian_map(n=16, step=1.0, sigma=1.0, tau=3.0) * 1e-6
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / form
        if form == "m.npy":
            np.save(path, z)
        else:
            kind = sdfio.FileFormat.ASCII if form == "a.sdf" else sdfio.FileFormat.BINARY
            sdfio.write(path, z, x_scale=1e-6, y_scale=1e-6, format=kind)
        data = path.read_bytes()
        # Half of the damage falls into the header.
        k = int(at**2 * len(data))
        path.write_bytes(data[:k] + junk + (b"" if cut else data[k + len(junk) :]))
        message = message_of(lambda p: read_surface(p, spacing=1.0, x_unit="um", z_unit="um"), path)
        assert message is None or path.name in message


@given(
    words=st.lists(
        st.sampled_from(
            [
                "400",
                "0,5",
                "1e3",
                "nan",
                "inf",
                "x",
                "#",
                ";",
                ",",
                "\t",
                "\n",
                "\n",
                " ",
                "-",
                "{",
                "%",
                "[nm]",
            ]
        ),
        max_size=60,
    )
)
@settings(max_examples=400, deadline=None)
def test_no_text_ends_in_anything_but_numbers_or_an_error(words):
    message = message_of(read_text, "".join(words))
    assert message is None or "t.txt" in message


def test_names_of_columns_are_read_with_and_without_a_comment_mark():
    for head in ("Wavelength (nm),R %\n", "# Wavelength (nm),R %\n", "#about\n\n#Wavelength (nm), R %\n"):
        assert read_text(head + "400,50\n410,51\n").names == ["Wavelength (nm)", "R %"]


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("", ("no data",)),
        ("hello\nworld\n", ("line 1", "hello", "no row of numbers")),
        ("1,2\n3,bright\n", ("line 2", "bright", "a number")),
        ("1,2\n\n# note\n3,4,5\n", ("line 4", "3 columns", "allowed 2")),
        ("1,2\n3,\n", ("line 2", "1 columns")),
        ("1" * 20_000_000 + "\n", ("line 1", "20000000 characters")),
    ],
)
def test_a_broken_table_is_named_with_its_line(text, names):
    with pytest.raises(gonio.FormatError) as error:
        read_text(text)
    for name in names:
        assert name in str(error.value)


def spectrum_file(folder, text):
    path = folder / "s.csv"
    path.write_text(text)
    return path


def rows(values, start=380, step=10, scale=1.0):
    return "".join(f"{(start + step * k) * scale:g},{v}\n" for k, v in enumerate(values))


def test_percent_is_taken_from_the_name_or_from_the_user_and_never_guessed(tmp_path):
    body = rows([50.0] * 41)
    assert gonio.colour(spectrum_file(tmp_path, "nm,R %\n" + body))[0].photopic == pytest.approx(0.5)
    path = spectrum_file(tmp_path, body)
    assert gonio.colour(path, percent=True)[0].photopic == pytest.approx(0.5)
    with pytest.raises(gonio.FormatError, match="--percent"):
        gonio.colour(path)
    assert gonio.colour(path, percent=False)[0].photopic == pytest.approx(50.0)


def test_a_spectrum_may_run_downwards(tmp_path):
    values = np.linspace(0.1, 0.7, 41)
    up = gonio.colour(spectrum_file(tmp_path, rows(values)))[0]
    down = gonio.colour(spectrum_file(tmp_path, rows(values[::-1], start=780, step=-10)))[0]
    assert down.rgb == up.rgb


def test_each_column_has_its_colour_and_can_be_chosen(tmp_path):
    text = "nm,SCI,SCE\n" + "".join(f"{w},0.5,0.4\n" for w in range(380, 781, 10))
    path = spectrum_file(tmp_path, text)
    assert [(c.name, round(c.photopic, 6)) for c in gonio.colour(path)] == [("SCI", 0.5), ("SCE", 0.4)]
    assert [c.name for c in gonio.colour(path, columns=["SCE"])] == ["SCE"]
    assert [c.name for c in gonio.colour(path, columns=["3", "2"])] == ["SCE", "SCI"]
    with pytest.raises(gonio.DomainError, match=r"column: found 'SCX', allowed SCI, SCE or 2 to 3"):
        gonio.colour(path, columns=["SCX"])


@pytest.mark.parametrize(
    ("text", "options", "names"),
    [
        (rows([0.5] * 41, scale=1e-3), {}, ("without a unit", "--wavelength-unit")),
        (rows([0.5] * 41), {"wavelength_unit": "um"}, ("380000",)),
        (rows([0.5] * 41) + "400,0.5\n", {}, ("400 nm", "more than once")),
        (rows([0.5] * 41).replace("500,0.5", "500,nan"), {}, ("row 13", "nan")),
        ("400\n500\n", {}, ("one column",)),
        (rows([0.5] * 41), {"wavelength_unit": "inch"}, ("inch",)),
        (rows([0.5] * 41), {"illuminant": "F2"}, ("illuminant", "F2")),
        (rows([0.5] * 10), {}, ("380 to 470",)),
    ],
)
def test_a_spectrum_that_is_none_is_named(tmp_path, text, options, names):
    with pytest.raises(gonio.GonioError) as error:
        gonio.colour(spectrum_file(tmp_path, text), **options)
    for name in names:
        assert name in str(error.value)


def profile_text(z, *, head, separator=";", factor_x=1.0, factor_z=1.0, step=0.5):
    lines = [f"{k * step * factor_x:.9g}{separator}{v * factor_z:.9g}" for k, v in enumerate(z)]
    return "\n".join([head, *lines]) + "\n"


@pytest.mark.parametrize("x_unit", UNITS)
@pytest.mark.parametrize("z_unit", UNITS)
def test_a_profile_in_any_units_is_the_same_surface(tmp_path, x_unit, z_unit):
    z = gaussian_profile(n=400, step=0.5, sigma=1.0, tau=5.0)
    text = profile_text(
        z, head=f"x [{x_unit}];z [{z_unit}]", factor_x=1 / UNITS[x_unit], factor_z=1 / UNITS[z_unit]
    )
    path = tmp_path / "p.csv"
    path.write_text(text)
    found = read_surface(path)
    assert found.dx == pytest.approx(0.5, rel=1e-6)
    np.testing.assert_allclose(found.z, z, rtol=1e-6, atol=1e-7)


def test_a_map_is_the_same_surface_in_every_format(tmp_path):
    z = gaussian_map(n=64, step=2.0, sigma=1.0, tau=8.0)[:48]
    z[3, 5] = np.nan
    np.save(tmp_path / "m.npy", z)
    np.savetxt(tmp_path / "m.txt", z, fmt="%.12g")
    head = "Channel: Height\nWidth: 128 µm\nHeight: 96 µm\nValue units: m"
    np.savetxt(tmp_path / "g.txt", z * 1e-6, header=head, encoding="latin-1")
    for name, form in (("b", sdfio.FileFormat.BINARY), ("a", sdfio.FileFormat.ASCII)):
        sdfio.write(tmp_path / f"{name}.sdf", z * 1e-6, x_scale=2e-6, y_scale=2e-6, format=form)
    stated = {"spacing": 2.0, "x_unit": "um", "z_unit": "um"}
    for name, options in (("m.npy", stated), ("m.txt", stated), ("g.txt", {}), ("a.sdf", {}), ("b.sdf", {})):
        found = read_surface(tmp_path / name, **options)
        assert (found.dx, found.dy) == pytest.approx((2.0, 2.0))
        np.testing.assert_allclose(found.z, z, atol=1e-6)


def test_heights_of_one_column_are_a_profile(tmp_path):
    z = gaussian_profile(n=200, step=1.0, sigma=1.0, tau=5.0)
    np.savetxt(tmp_path / "h.txt", z, header="z [nm]")
    found = read_surface(tmp_path / "h.txt", spacing=0.2, x_unit="mm")
    assert (found.dx, found.z.ndim) == (200.0, 1)
    np.testing.assert_allclose(found.z, z * 1e-3)


def write(tmp_path, name, content):
    path = tmp_path / name
    if isinstance(content, bytes):
        path.write_bytes(content)
    elif isinstance(content, str):
        path.write_text(content)
    else:
        np.save(path, content)
    return path


HEAD = "x [um];z [um]"
GOOD = [float(k % 7) for k in range(100)]


@pytest.mark.parametrize(
    ("name", "content", "options", "names"),
    [
        ("p.txt", profile_text(GOOD, head="x;z"), {}, ("x_unit", "--x-unit")),
        ("p.txt", profile_text(GOOD, head="x [um];z"), {}, ("z_unit", "--z-unit")),
        ("p.txt", profile_text(GOOD[:20], head=HEAD), {}, ("20 points", "50")),
        ("p.txt", profile_text([1.0] * 100, head=HEAD), {}, ("one height",)),
        ("p.txt", profile_text(GOOD, head=HEAD).replace("\n5;", "\n5.2;"), {}, ("step", "equal steps")),
        ("p.txt", profile_text(GOOD, head=HEAD).replace("\n5;", "\nnan;"), {}, ("nan for an x",)),
        ("p.txt", "1 2 3\n" * 60, {"x_unit": "um", "z_unit": "um"}, ("3 columns", "16")),
        ("p.txt", "5\n6\n" * 60, {"x_unit": "um", "z_unit": "um"}, ("spacing", "--spacing")),
        ("m.npy", np.zeros((4, 4)), {}, ("z_unit",)),
        ("m.npy", np.eye(4), {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}, ("4 x 4", "16")),
        ("m.npy", np.zeros((2, 2, 2)), {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}, ("3-dimensional",)),
        ("m.npy", np.array(["a"] * 60), {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}, ("<U1",)),
        ("m.npy", b"\x93NUMPY\x01\x00", {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}, ("m.npy",)),
        (
            "m.npy",
            np.full((20, 20), np.nan),
            {"spacing": 1.0, "x_unit": "um", "z_unit": "um"},
            ("0 %", "half"),
        ),
        ("m.npy", np.full((20, 20), np.inf), {"spacing": 1.0, "x_unit": "um", "z_unit": "um"}, ("infinite",)),
        ("m.sdf", b"aISO-1.0\r\n", {}, ("ISO 25178-71",)),
        ("m.sdf", b"", {}, ("ISO 25178-71",)),
        (
            "g.txt",
            "Width: -3 um\nHeight: 3 um\nValue units: m\n" + ("1 " * 16 + "\n") * 16,
            {},
            ("width", "-3"),
        ),
    ],
)
def test_a_surface_that_is_none_is_named(tmp_path, name, content, options, names):
    path = write(tmp_path, name, content)
    with pytest.raises(gonio.FormatError) as error:
        gonio.roughness(path, **options)
    for part in (name, *names):
        assert part in str(error.value)
