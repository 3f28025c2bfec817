import json

import gonio
import numpy as np
import pyarrow.parquet as pq
import pytest
import xarray as xr


def piece(theta_i=30.0, *, channel="532nm", readings=5):
    theta_s = np.linspace(0.0, 180.0, readings)
    return gonio.Slice(
        theta_i=theta_i,
        phi_i=10.0,
        channel=channel,
        theta_s=theta_s,
        phi_s=np.full(readings, 190.0),
        dsf=np.linspace(-0.1, 0.3, readings),
        u_dsf=np.full(readings, 0.01),
        omega=np.full(readings, 0.02),
        flags=np.arange(readings, dtype=np.uint16),
        u_common=0.003,
        integrals=[
            gonio.HemisphericalIntegral(
                side="front", value=0.9, extrapolated=0.05, u=0.01, u_quadrature=0.002
            )
        ],
    )


RESOLUTION = gonio.Resolution(
    channel="photopic",
    fwhm=0.7,
    radius_50=0.35,
    radius_90=0.6,
    second_moment=0.15,
    receiver_radius=0.25,
    spot_radius=0.1,
)
SAID = ("channel", "fwhm", "radius_50", "radius_90", "second_moment", "receiver_radius", "spot_radius")


@pytest.fixture
def measurement():
    return gonio.Measurement(
        [piece(), piece(60.0, channel="photopic", readings=3)],
        sample_name="PTFE",
        signature_fwhm=0.7,
        resolutions=[RESOLUTION],
        warnings=["dhr above 1"],
        provenance={"inputs": [{"name": "a.txt", "sha256": "0" * 64}]},
    )


def same(a, b):
    for name in ("theta_i", "phi_i", "channel", "u_common"):
        assert getattr(a, name) == pytest.approx(getattr(b, name), abs=1e-12)
    for name in ("theta_s", "phi_s", "dsf", "u_dsf", "omega", "flags"):
        np.testing.assert_allclose(getattr(a, name), getattr(b, name), rtol=0, atol=1e-12)
    assert [(i.side, i.value, i.extrapolated, i.u, i.u_quadrature) for i in a.integrals] == [
        (i.side, i.value, i.extrapolated, i.u, i.u_quadrature) for i in b.integrals
    ]


def test_a_saved_measurement_comes_back(measurement, tmp_path):
    measurement.save(tmp_path / "m")
    back = gonio.Measurement.load(tmp_path / "m")
    for a, b in zip(measurement.slices, back.slices, strict=True):
        same(a, b)
    assert back.sample_name == "PTFE"
    assert back.signature_fwhm == pytest.approx(0.7)
    (resolution,) = back.resolutions
    for name in SAID:
        assert getattr(resolution, name) == pytest.approx(getattr(RESOLUTION, name))
    assert back.warnings == ["dhr above 1"]
    assert back.provenance == measurement.provenance
    assert sorted(p.name for p in tmp_path.iterdir()) == ["m"]


def test_a_resolution_must_be_positive():
    figures = {"channel": "photopic", "fwhm": 0.7, "radius_50": 0.3, "radius_90": 0.6, "second_moment": 0.1}
    for name in ("fwhm", "radius_50", "radius_90", "second_moment", "receiver_radius", "spot_radius"):
        with pytest.raises(gonio.DomainError, match=rf"{name}: found 0.*> 0"):
            gonio.Resolution(**figures | {name: 0.0})


def test_the_bsdf_is_the_dsf_over_the_cosine_and_nan_on_the_horizon():
    s = piece()
    assert s.bsdf[0] == pytest.approx(s.dsf[0])
    assert s.bsdf[1] == pytest.approx(s.dsf[1] / np.cos(np.pi / 4))
    assert s.bsdf[4] == pytest.approx(s.dsf[4])  # theta_s = 180: |cos| = 1


def test_flags_must_be_uint16():
    with pytest.raises(TypeError):
        gonio.Slice(
            theta_i=0,
            phi_i=0,
            channel="photopic",
            theta_s=[0.0],
            phi_s=[0.0],
            dsf=[1.0],
            u_dsf=[0.1],
            omega=[0.1],
            flags=np.array([0.5]),
        )


def test_the_table_has_one_row_a_reading_and_names_its_units(measurement):
    table = measurement.to_table()
    assert table.num_rows == 8
    assert table["slice"].to_pylist() == [0] * 5 + [1] * 3
    assert table["channel"].to_pylist() == ["532nm"] * 5 + ["photopic"] * 3
    assert table.schema.field("dsf").metadata[b"unit"] == b"sr-1"
    assert table.schema.field("theta_s").metadata[b"unit"] == b"degree"


def test_an_empty_measurement_is_saved_and_read(tmp_path):
    gonio.Measurement([]).save(tmp_path / "m")
    assert gonio.Measurement.load(tmp_path / "m").slices == []


def test_the_netcdf_carries_units_quantity_frame_and_provenance(measurement, tmp_path):
    measurement.to_netcdf(tmp_path / "m.nc")
    with xr.open_dataset(tmp_path / "m.nc", engine="h5netcdf") as data:
        assert data["dsf"].attrs["units"] == "sr-1"
        assert data.attrs["quantity"] == "dsf"
        assert "right-handed" in data.attrs["frame"]
        assert json.loads(data.attrs["provenance"]) == measurement.provenance
        assert data["row_size"].values.tolist() == [5, 3]
        assert data["integral"].sel(side="front").values == pytest.approx([0.9, 0.9])
        assert np.isnan(data["integral"].sel(side="back").values).all()
        assert data["channel"].values.tolist() == ["532nm", "photopic"]


def test_an_earlier_measurement_is_replaced_and_other_files_stay(measurement, tmp_path):
    measurement.save(tmp_path / "m")
    (tmp_path / "m" / "report.html").write_text("mine")
    gonio.Measurement(measurement.slices[:1]).save(tmp_path / "m")
    assert len(gonio.Measurement.load(tmp_path / "m")) == 1
    assert (tmp_path / "m" / "report.html").read_text() == "mine"


def test_a_directory_with_other_files_needs_force(measurement, tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(gonio.FormatError, match="other files"):
        measurement.save(tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.tex"]
    measurement.save(tmp_path, force=True)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"
    assert len(gonio.Measurement.load(tmp_path)) == 2


def test_a_missing_parent_is_an_os_error(measurement, tmp_path):
    with pytest.raises(FileNotFoundError, match="no such directory"):
        measurement.save(tmp_path / "none" / "m")


def test_an_interrupted_save_leaves_nothing(measurement, tmp_path, monkeypatch):
    def interrupted(*args, **kwargs):
        raise KeyboardInterrupt

    monkeypatch.setattr(pq, "write_table", interrupted)
    with pytest.raises(KeyboardInterrupt):
        measurement.save(tmp_path / "m")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (lambda d: (d / "measurement.json").write_text("{"), "no JSON"),
        (lambda d: (d / "measurement.json").write_text("[]"), "gonio-measurement"),
        (lambda d: (d / "measurement.json").write_bytes(b"\xff\xfe"), "no JSON"),
        (lambda d: (d / "measurement.parquet").write_bytes(b""), "SHA-256"),
        (lambda d: edit(d, lambda h: h.update(format_version=99)), "format_version: found 99"),
        (lambda d: edit(d, lambda h: h.pop("slices")), "slices"),
        (lambda d: edit(d, lambda h: h["slices"][0].pop("theta_i")), "damaged"),
        (lambda d: edit(d, lambda h: h["slices"][0].update(theta_i=200)), "theta_i"),
        (lambda d: edit(d, lambda h: h["slices"].pop()), "rows"),
    ],
)
def test_a_damaged_measurement_is_a_format_error_that_names_the_fault(measurement, tmp_path, damage, message):
    measurement.save(tmp_path / "m")
    damage(tmp_path / "m")
    with pytest.raises(gonio.FormatError, match=message) as error:
        gonio.Measurement.load(tmp_path / "m")
    assert str(tmp_path / "m") in str(error.value)


def edit(directory, change):
    path = directory / "measurement.json"
    header = json.loads(path.read_text())
    change(header)
    path.write_text(json.dumps(header))


def test_a_missing_measurement_is_a_missing_file(tmp_path):
    with pytest.raises(FileNotFoundError):
        gonio.Measurement.load(tmp_path / "none")


def test_the_netcdf_names_the_convention_it_follows(measurement):
    attrs = measurement.to_xarray().attrs
    assert attrs["Conventions"].startswith("CF-1.")
    assert "featureType" not in attrs  # CF knows features in space and time only
    assert attrs["format"] == "gonio-measurement"


@pytest.mark.parametrize("name", ["GonioError", "FormatError", "QuantityError", "DomainError", "FitError"])
def test_an_error_shows_the_name_it_is_imported_by(name):
    error = getattr(gonio, name)
    assert f"{error.__module__}.{error.__qualname__}" == f"gonio.{name}"
