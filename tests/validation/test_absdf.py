"""RADIANCE shows what lies behind a pane sharp, in the share of light that passes unscattered."""

import gonio
import numpy as np
import pytest

CURTAIN = "void trans curtain\n0\n0\n7 .8 .8 .8 0 0 .6 .5\n"
THROUGH = 0.24

SCENE = """void aBSDF win
5 c.xml 0 1 0 .
0
0
win polygon w
0
0
12 -1 -1 0 1 -1 0 1 1 0 -1 1 0
void glow g
0
0
4 1 1 1 0
g sphere s
0
0
4 0 0 -10 .3
"""
"""A pane before a glowing sphere of 1.1 degrees' radius, which is no light source to rtrace: without ambient
bounces it is seen unscattered only."""


@pytest.mark.parametrize("to", ["radiance-klems", "radiance-ttree"])
def test_an_absdf_of_an_exported_file_passes_the_unscattered_share(radiance, tmp_path, to):
    (tmp_path / "c.rad").write_text(CURTAIN)
    gonio.export(tmp_path / "c.rad", to=to, channel="green", out=tmp_path / "c.xml", as_visible=True)

    def green(scene, rays):
        (tmp_path / "scene.rad").write_text(scene)
        (tmp_path / "scene.oct").write_bytes(radiance.run("oconv", "scene.rad", cwd=tmp_path))
        command = ("rtrace", "-h", "-ab", "0", "-ov", "scene.oct")
        text = radiance.run(*command, cwd=tmp_path, stdin=rays.encode()).decode()
        return np.array([float(line.split()[1]) for line in text.splitlines() if line.strip()])

    rays = "".join(f"0 0 5 {x} 0 -1\n" for x in (0.0, 0.01, 0.018, 0.03))
    np.testing.assert_allclose(green(SCENE, rays), [THROUGH, THROUGH, THROUGH, 0.0], rtol=0.005)
    # both sides of the borders of large cells of incidence, at sines of 1/4, 1/2 and 3/4
    for theta in (10.0, 14.4, 14.6, 29.8, 30.2, 48.5, 48.7, 60.0):
        x, z = np.sin(np.radians(theta)), np.cos(np.radians(theta))
        for side in (1, -1):
            scene = SCENE.replace("4 0 0 -10 .3", f"4 {10 * x} 0 {-10 * z * side} .3")
            ray = f"{-5 * x} 0 {5 * z * side} {x} 0 {-z * side}\n"
            np.testing.assert_allclose(green(scene, ray), [THROUGH], rtol=0.005)
