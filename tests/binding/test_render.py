"""Pictures and sensors through the Python interface."""

import subprocess
import sys
import threading

import gonio
import numpy as np
import pytest
from gonio import picture_files, rendering_state
from gonio.working import finishing
from matplotlib.image import imread

RED = gonio.analytic({"model": "lambert", "rho": {"red": 0.6, "green": 0.2, "blue": 0.1}})
SENSORS = [[0.0, 0.0, 5.0, 0.0, 0.0, 1.0], [2.0, 2.0, 0.001, 0.0, 0.0, 3.0]]


@pytest.fixture(scope="module")
def studio():
    return gonio.studio_scene(RED)


def stopping_after(share, limit=1):
    """A progress callback that presses Ctrl-C, once."""
    pressed = []

    def report(progress):
        if progress.done >= share and len(pressed) < limit:
            pressed.append(progress)
            raise KeyboardInterrupt

    return report


def same(a, b):
    return all(
        np.array_equal(getattr(a, name), getattr(b, name))
        for name in ("radiance", "luminance", "standard_error", "samples")
    )


def test_one_seed_gives_one_picture_on_any_number_of_threads(studio):
    scene, view = studio
    one, two, many = (
        gonio.render(scene, view=view, size=40, samples=48, seed=3, threads=n) for n in (1, 2, 5)
    )
    assert same(one, two)
    assert same(one, many)
    assert not same(one, gonio.render(scene, view=view, size=40, samples=48, seed=4))


@pytest.mark.parametrize("relative_error", [None, 0.02])
def test_an_interrupted_picture_goes_on_to_the_very_picture_of_one_run(tmp_path, studio, relative_error):
    scene, view = studio
    out = tmp_path / "ball.exr"
    options = {"view": view, "size": 64, "samples": 600, "relative_error": relative_error}
    whole = gonio.render(scene, **options)
    with pytest.raises(KeyboardInterrupt, match=r"ball.exr.samples.npz keeps the samples.*--resume"):
        gonio.render(scene, out=out, progress=stopping_after(0.05), **options)
    assert not out.exists()
    kept = np.load(tmp_path / "ball.exr.samples.npz")["count"]
    assert 0 < kept.sum() < whole.samples.sum()
    assert same(gonio.render(scene, out=out, resume=True, **options), whole)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["ball.exr", "ball.exr.samples.npz"]


def test_samples_accumulate_across_runs(tmp_path, studio):
    scene, view = studio
    out = tmp_path / "ball.hdr"
    for samples in (32, 96):
        found = gonio.render(scene, view=view, out=out, size=32, samples=samples, resume=True)
    assert same(found, gonio.render(scene, view=view, size=32, samples=96))
    # A finished picture without resume leaves nothing beside it.
    gonio.render(scene, view=view, out=out, size=32, samples=32)
    assert [p.name for p in tmp_path.iterdir()] == ["ball.hdr"]


def test_kept_samples_of_another_picture_are_refused(tmp_path, studio):
    scene, view = studio
    out = tmp_path / "ball.hdr"
    gonio.render(scene, view=view, out=out, size=32, samples=16, resume=True)
    other, _ = gonio.studio_scene(gonio.analytic({"model": "lambert", "rho": 0.1}))
    for arguments, name in (
        ({"seed": 2}, "seed"),
        ({"size": 33}, "width"),
        ({"view": "-vtv -vp 0 -5 1"}, "view"),
        ({"scene": other}, "scene"),
    ):
        given = {"scene": scene, "view": view, "out": out, "size": 32, "samples": 16, "resume": True}
        with pytest.raises(gonio.DomainError, match=name):
            gonio.render(**given | arguments)
    rendering_state.state_path(out).write_bytes(b"no samples")
    with pytest.raises(gonio.FormatError, match="found no samples"):
        gonio.render(scene, view=view, out=out, size=32, samples=16, resume=True)


def test_the_error_stops_the_samples(studio):
    scene, view = studio
    found = gonio.render(scene, view=view, size=48, samples=4096, relative_error=0.03)
    floor = 0.01 * found.luminance.mean()
    done = found.standard_error <= 0.0301 * np.maximum(found.luminance, floor)
    assert (done | (found.samples == 4096)).all()
    assert found.samples.min() < 200 < found.samples.max()


def test_sensors_agree_with_the_picture_of_a_hemisphere(studio):
    # Of a fish-eye in orthographic projection, the mean radiance over the circle is the irradiance over pi.
    scene, _ = studio
    found = gonio.render_sensors(scene, SENSORS, relative_error=2e-3)
    for k, (x, y, z, *_) in enumerate(SENSORS):
        text = f"-vth -vp {x} {y} {z} -vd 0 0 1 -vu 0 1 0 -vh 180 -vv 180"
        view = gonio.render(scene, view=text, size=128, samples=256)
        mean = view.luminance.sum() / (0.25 * np.pi * 128**2)
        error = np.sqrt((view.standard_error**2).sum()) / (0.25 * np.pi * 128**2)
        spread = 4.0 * np.hypot(np.pi * error, found.standard_error[k])
        # The border of the circle crosses pixels: their samples count as they fall.
        assert abs(np.pi * mean - found.illuminance[k]) < spread + 1e-4 * found.illuminance[k]
    weights = 179.0 * np.array([0.265074, 0.670115, 0.064811])
    assert found.illuminance == pytest.approx(found.irradiance @ weights, rel=1e-5)


def test_sensors_resume_too(tmp_path, studio):
    scene, _ = studio
    out = tmp_path / "lux.txt"
    options = {"samples": 400_000, "relative_error": None}
    whole = gonio.render_sensors(scene, SENSORS, **options)
    with pytest.raises(KeyboardInterrupt, match="keeps the samples"):
        gonio.render_sensors(scene, SENSORS, state=out, progress=stopping_after(0.01), **options)
    again = gonio.render_sensors(scene, SENSORS, state=out, resume=True, **options)
    assert np.array_equal(again.irradiance, whole.irradiance)
    assert np.array_equal(again.standard_error, whole.standard_error)


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ({"size": 0}, "size"),
        ({"size": (0, 4)}, "size"),
        ({"samples": 0}, "samples"),
        ({"relative_error": 0.0}, "relative_error"),
        ({"seed": -1}, "seed"),
        ({"bounces": -1}, "bounces"),
        ({"threads": 0}, "threads"),
        ({"view": "-vh 0"}, "-vh"),
        ({"out": "ball.jpg"}, r"\.jpg"),
        ({"resume": True}, "resume"),
    ],
)
def test_what_cannot_be_rendered_is_named(studio, arguments, name):
    scene, view = studio
    with pytest.raises(gonio.DomainError, match=name):
        gonio.render(scene, **{"view": view, "samples": 16, "size": 8} | arguments)


def test_unknown_view_options_are_named(studio):
    for text, name in (("-vtq", "-vt"), ("-vtv -ab 2", "-ab"), ("-vp 1 2", "-vp")):
        with pytest.raises(gonio.FormatError, match=name):
            gonio.render(studio[0], view=text, size=8, samples=16)


def test_sensors_that_look_nowhere_are_named(studio):
    scene, _ = studio
    with pytest.raises(gonio.DomainError, match="sensor 2"):
        gonio.render_sensors(scene, [SENSORS[0], [0, 0, 0, 0, 0, 0]])
    with pytest.raises(gonio.DomainError, match="rows of 6"):
        gonio.render_sensors(scene, [[1, 2, 3]])


def test_a_missing_view_file_is_named(tmp_path, studio):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.vf"):
        gonio.render(studio[0], view=tmp_path / "nowhere.vf")


def test_an_error_in_the_work_and_an_interruption_wait_for_its_end():
    ended = threading.Event()
    stop = threading.Event()

    def work():
        stop.wait()
        ended.set()

    def press():
        raise KeyboardInterrupt

    came = finishing(work, tick=press, stop=stop.set)
    assert isinstance(came, KeyboardInterrupt)
    assert ended.is_set()


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_ctrl_c_itself_waits_for_the_end_of_the_work():
    # A signal, not an exception of ours: it may arrive within any wait.
    code = """
import os, signal, threading, time
from gonio.working import finishing
# A shell that starts tests in the background leaves the signal ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
ended = []
def work():
    time.sleep(0.5)
    ended.append(True)
threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
print(type(finishing(work)).__name__, ended)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["KeyboardInterrupt", "[True]"]


def test_radiance_reads_the_picture(tmp_path, studio):
    pyradiance = pytest.importorskip("pyradiance")
    scene, view = studio
    file = tmp_path / "ball.hdr"
    found = gonio.render(scene, view=view, out=file, size=(70, 50), samples=32)
    header = pyradiance.getinfo(file).decode()
    assert found.view in header
    assert "EXPOSURE=1" in header
    # RADIANCE writes six digits.
    assert "-vtv -vp 0 -6.5 3.1 -vd 0 6.5 -2.18 " in str(pyradiance.viewfile(str(file)))
    text = pyradiance.pvalue(file, header=False, resstr=False)
    values = np.array([row.split() for row in text.decode().splitlines() if len(row.split()) == 5], float)
    read = np.zeros_like(found.radiance)
    height = found.radiance.shape[0]
    read[height - 1 - values[:, 1].astype(int), values[:, 0].astype(int)] = values[:, 2:]
    largest = found.radiance.max(axis=2, keepdims=True)
    # Half a step of the mantissa, and the four digits that pvalue prints.
    assert (np.abs(read - found.radiance) <= largest * (1.0 / 256.0 + 5e-4)).all()


def test_false_colours_and_tones_are_whole_pictures(tmp_path, studio):
    scene, view = studio
    picture = gonio.render(scene, view=view, size=32, samples=16)
    gonio.false_colour(picture.luminance, out=tmp_path / "false.png")
    gonio.tone_mapped(picture, out=tmp_path / "tones.png")
    assert imread(tmp_path / "tones.png").shape[:2] == (32, 32)
    tones = imread(tmp_path / "tones.png")[..., :3]
    # The ball in the middle is red.
    assert tones[16, 16, 0] > 1.3 * tones[16, 16, 1]
    assert imread(tmp_path / "false.png").shape[0] > 32
    with pytest.raises(gonio.DomainError, match="low, high"):
        gonio.false_colour(picture.luminance, out=tmp_path / "false.png", low=2.0, high=1.0)
    black = picture_files.Picture(0 * picture.radiance, 0 * picture.luminance, *(2 * [0 * tones[..., 0]]), "")
    gonio.tone_mapped(black, out=tmp_path / "black.png")
    assert imread(tmp_path / "black.png")[..., :3].max() == 0.0
    gonio.false_colour(black.luminance, out=tmp_path / "black.png")


def test_a_preview_shows_named_materials_and_files(tmp_path):
    file = tmp_path / "paint.rad"
    file.write_text("void plastic paint 0 0 5 .1 .2 .6 .05 .1\n")
    blue = gonio.preview(file, size=24, samples=32)
    assert blue.radiance[12, 12, 2] > 2.0 * blue.radiance[12, 12, 0]
    grey = gonio.preview("lambert", size=24, samples=32)
    assert grey.radiance[12, 12, 2] == pytest.approx(grey.radiance[12, 12, 0])
    with pytest.raises(gonio.QuantityError, match="needed one, or red, green, blue"):
        gonio.preview(gonio.analytic({"model": "lambert", "rho": {"532nm": 0.5, "650nm": 0.5}}))
    with pytest.raises(gonio.DomainError, match="no file"):
        gonio.preview(tmp_path / "nowhere.xml")
