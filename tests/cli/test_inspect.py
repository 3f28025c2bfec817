import json

import gonio
import numpy as np
import pytest
from gonio import _native
from gonio.readings import FORMATS

from tests.cli.conftest import one_clear_error
from tests.cli.test_build import lambertian


@pytest.fixture
def raw(tmp_path):
    path = tmp_path / "sample.txt"
    scan = gonio.Scan(theta_i=30, phi_i=0, theta_s=[1, 2, 2], phi_s=[3, 40, 40], value=[1, np.nan, -3])
    gonio.Readings([scan]).save(path)
    return path


def test_inspect_shows_what_is_in_a_file(run, raw):
    done = run("inspect", raw)
    assert done.code == 0
    for text in ("gonio-raw", "theta_i 30", "3 readings", "1 negative", "1 no data", "1 repeated"):
        assert text in done.out
    assert "--beam or --standard" in done.err
    assert "--dark" in done.err


def test_inspect_does_not_ask_for_a_dark_that_is_among_the_files(run, raw, tmp_path):
    dark = gonio.Scan(theta_i=0, phi_i=0, theta_s=[0, 0], phi_s=[0, 0], value=[1, 2], kind="dark")
    gonio.Readings([dark]).save(tmp_path / "dark.txt")
    assert "--dark" not in run("inspect", raw, tmp_path / "dark.txt").err


def test_inspect_names_sample_instrument_and_azimuths_and_asks_for_a_dark(run, tmp_path):
    meta = {"sample_name": "half white", "instrument": "bench 2"}
    scan = gonio.Scan(theta_i=30, phi_i=0, theta_s=[1, 2], phi_s=[3, 40], value=[1, 2], meta=meta)
    gonio.Readings([scan]).save(tmp_path / "a.txt")
    done = run("inspect", "a.txt")
    for text in ("1 record; angles in deg", "sample half white", "instrument bench 2", "phi_s 3 to 40"):
        assert text in done.out
    assert "--dark of gonio process" in done.err


@pytest.mark.parametrize("kind", ["dark", "beam"])
def test_a_dark_or_a_beam_scan_alone_asks_for_nothing(run, tmp_path, kind):
    scan = gonio.Scan(kind=kind, theta_i=0, phi_i=0, theta_s=[0, 0], phi_s=[0, 0], value=[1, 2])
    gonio.Readings([scan]).save(tmp_path / "a.txt")
    done = run("inspect", "a.txt")
    assert (done.code, done.err) == (0, "")
    assert ("repeated" in done.out) == (kind == "beam")


def test_a_bad_file_does_not_stop_the_others(run, raw, tmp_path):
    (tmp_path / "bad.txt").write_text("no readings\n")
    done = run("inspect", "bad.txt", "none.txt", raw)
    assert done.code == 2
    assert "3 readings" in done.out
    assert "gonio: bad.txt: file: found" in done.err
    assert "gonio: none.txt: No such file" in done.err
    found = json.loads(run("inspect", "--json", "bad.txt", raw).out)
    assert (found["readings"], list(found["failed"])) == (3, ["bad.txt"])
    with pytest.raises(gonio.FormatError):
        gonio.inspect([raw, tmp_path / "bad.txt"])


@pytest.mark.parametrize("rank", [None, 3, 4])
def test_inspect_shows_representation_components_and_albedo_of_an_xml(run, tmp_path, rank):
    model = _native.analytic([{"model": "lambert", "rho": 0.5}])
    to, options = ("radiance-ttree", {"rank": rank}) if rank else ("radiance-klems", {"basis": "half"})
    options |= {"name": "half white", "manufacturer": "none", "components": [("front", "reflection")]}
    written = gonio.export(model, to=to, out=tmp_path / "a.xml", **options)
    done = run("inspect", "a.xml")
    assert done.code == 0
    shown = f"tensor-tree (rank {rank}, " if rank else "klems (LBNL/Klems Half)"
    told = ("radiance-xml, 1 component", "half white", "photopic", "front reflection", shown)
    for text in (*told, "albedo 0.5000 to 0.5000"):
        assert text in done.out
    assert "gonio.read_bsdf" in done.err
    (component,) = gonio.inspect(tmp_path / "a.xml").files[0].model.components
    assert component.albedo_max == pytest.approx(written.report["max_albedo"], rel=1e-6)


def test_inspect_lists_every_channel_of_an_xml(run, tmp_path):
    model = _native.analytic([{"model": "lambert", "rho": 0.5}])
    front = [("front", "reflection")]
    gonio.export(model, to="radiance-klems", basis="quarter", components=front, out=tmp_path / "a.xml")
    text = (tmp_path / "a.xml").read_text()
    start, end = text.index("<WavelengthData>"), text.rindex("</WavelengthData>") + len("</WavelengthData>")
    solar = text[start:end].replace("Visible", "Solar")
    (tmp_path / "a.xml").write_text(text[:end] + solar + text[end:])
    components = gonio.inspect(tmp_path / "a.xml").files[0].model.components
    assert [c.channel for c in components] == ["photopic", "solar"]
    one_clear_error(run("inspect", "a.xml", "--channel", "532nm"), "a.xml", "532nm")


@pytest.mark.parametrize("to", ["csv", "parquet", "netcdf"])
def test_an_exported_table_says_how_it_can_be_read(run, tmp_path, to):
    gonio.export(gonio.process([lambertian(10)]), to=to, out=tmp_path / "table")
    one_clear_error(run("inspect", "table"), "table", "directory that gonio process wrote")
    if to != "netcdf":
        done = run("inspect", "table", "--column", "value=dsf", "--quantity", "dsf")
        assert "648 readings" in done.out


def test_every_format_is_named_where_one_is_unknown(run, raw):
    for options in (["--format", "word"], []):
        path = raw if options else raw.with_name("bad.txt")
        raw.with_name("bad.txt").write_text("no readings\n")
        done = run("inspect", path, *options)
        for name in FORMATS:
            assert name in done.err
    assert run("inspect", raw, "--format", "Gonio-Raw").code == 0


def test_the_up_mark_can_be_stated(run, tmp_path):
    scan = gonio.Scan(quantity="bsdf", theta_i=30, phi_i=0, theta_s=[20], phi_s=[70], value=[1])
    _native.write_mountain(tmp_path / "m.txt", scan)
    assert "phi_s 80 to 80" in run("inspect", "m.txt", "--upphi", "80").out


def test_inspect_json_is_one_object_and_nothing_else(run, raw):
    done = run("inspect", "--json", raw)
    assert done.code == 0
    found = json.loads(done.out)
    assert found["readings"] == 3
    assert found["incidences"] == [[30.0, 0.0]]
    assert found["files"][0]["format"] == "gonio-raw"
    assert len(found["files"][0]["sha256"]) == 64


def test_the_version_is_printed(run_apart):
    assert run_apart("--version").out.strip() == f"gonio {gonio.__version__}"


def test_debug_shows_the_traceback(run, tmp_path):
    done = run("inspect", "--debug", tmp_path / "none")
    assert done.code == 2
    assert "Traceback" in done.err


def test_a_missing_file_and_a_directory_are_one_clear_error(run, tmp_path):
    one_clear_error(run("inspect", tmp_path / "none.txt"), "none.txt", "No such file")
    one_clear_error(run("inspect", tmp_path), tmp_path, "directory")
