import gonio
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest


@pytest.fixture
def scans():
    beam = gonio.Scan(
        kind="beam",
        theta_i=0,
        phi_i=0,
        theta_s=[179, 180],
        phi_s=[0, 0],
        value=[5.0, 100.0],
        time=[0.0, 0.5],
        meta={"distance": 1.5, "started": "2026-03-01T10:00:00Z"},
    )
    empty = gonio.Scan(theta_i=20, phi_i=0, channel="532nm", theta_s=[], phi_s=[], value=[])
    sample = gonio.Scan(
        theta_i=20, phi_i=0, channel="532nm", theta_s=[0, 45, 90], phi_s=[0, 1, 2], value=[1, np.nan, -2]
    )
    return gonio.Readings([beam, empty, sample])


def test_scans_round_trip_through_raw_parquet(scans, tmp_path):
    path = tmp_path / "raw.parquet"
    scans.save(path)
    back = gonio.read(path)
    for a, b in zip(scans, back, strict=True):
        assert (a.kind, a.quantity, a.channel, len(a)) == (b.kind, b.quantity, b.channel, len(b))
        np.testing.assert_allclose(a.theta_s, b.theta_s, atol=1e-12)
        np.testing.assert_allclose(a.phi_s, b.phi_s, atol=1e-12)
        np.testing.assert_array_equal(a.value, b.value)
        assert {**a.meta, "source": str(path)} == b.meta
    assert back[0].time == pytest.approx([0.0, 0.5])
    assert back[2].time is None


def test_readings_select_by_kind_and_channel(scans):
    assert [s.kind for s in scans.select(kind="beam")] == ["beam"]
    assert len(scans.select(channel="532nm")) == 2
    assert len(scans[1:]) == 2
    assert len(scans + scans) == 6


@pytest.fixture
def foreign(tmp_path):
    path = tmp_path / "foreign.parquet"
    table = pa.table(
        {
            "inc": [30.0, 30.0, 10.0, 30.0],
            "phi_i": [0.0] * 4,
            "theta_s": [1.0, 2.0, 3.0, 4.0],
            "phi_s": [0.0] * 4,
            "brdf": [1.0, 2.0, 3.0, 4.0],
            "channel": ["red", "blue", "red", "red"],
        }
    )
    pq.write_table(table, path)
    return path


def test_a_foreign_table_is_split_by_incidence_and_channel(foreign):
    columns = {"theta_i": "inc", "value": "brdf"}
    scans = gonio.read(foreign, columns=columns, quantity="bsdf")
    assert [(s.theta_i, s.channel, s.value.tolist()) for s in scans] == [
        (pytest.approx(30), "red", [1, 4]),
        (pytest.approx(30), "blue", [2]),
        (pytest.approx(10), "red", [3]),
    ]


def test_a_foreign_table_reads_as_the_same_table_in_csv(tmp_path):
    table = {"angle": [-60.0, 0.0, 60.0, 190.0], "brdf": [1.0, 2.0, 3.0, 4.0]}
    pq.write_table(pa.table(table), tmp_path / "a.parquet")
    rows = ["angle,brdf", *(f"{t},{v}" for t, v in zip(*table.values(), strict=True))]
    (tmp_path / "a.csv").write_text("\n".join(rows) + "\n")
    columns = {
        "theta_i": "-10",
        "phi_i": "0",
        "theta_s": "angle",
        "phi_s": "90",
        "value": "brdf",
        "time": "5",
    }
    scans = [
        gonio.read(tmp_path / name, format=kind, columns=columns, quantity="bsdf", channel="532nm")[0]
        for name, kind in (("a.parquet", None), ("a.csv", "table"))
    ]
    for s in scans:
        assert (s.theta_i, s.phi_i) == (10, 180)
        assert s.theta_s.tolist() == [60, 0, 60, 170]
        assert s.phi_s.tolist() == [270, 90, 90, 270]
        assert s.value.tolist() == [1, 2, 3, 4]
        assert s.time.tolist() == [5, 5, 5, 5]


@pytest.mark.parametrize(
    ("options", "error", "names"),
    [
        ({}, gonio.DomainError, ("theta_i", "inc")),
        ({"columns": {"theta_i": "gone"}}, gonio.DomainError, ("gone", "inc")),
        ({"columns": {"angle": "inc"}}, gonio.DomainError, ("angle", "theta_i")),
        ({"columns": {"theta_i": "inc", "value": "brdf"}}, gonio.QuantityError, ("quantity",)),
        ({"columns": {"theta_i": "channel", "value": "brdf"}, "quantity": "bsdf"}, gonio.FormatError, ()),
    ],
)
def test_a_wrong_mapping_names_file_and_column(foreign, options, error, names):
    with pytest.raises(error) as caught:
        gonio.read(foreign, **options)
    for name in (str(foreign), *names):
        assert name in str(caught.value)


@pytest.mark.parametrize("cut", [0, 1, 100, -1])
def test_a_truncated_parquet_file_is_a_format_error(scans, tmp_path, cut):
    path = tmp_path / "raw.parquet"
    scans.save(path)
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(gonio.FormatError, match=r"raw\.parquet"):
        gonio.read(path)
