"""Radiance materials against RADIANCE itself: random parameters, random pairs of directions."""

import gonio
import numpy as np
import pytest

from .radiance_materials import (
    CUT,
    ROUGH,
    SMOOTH,
    Case,
    compare,
    compare_ideal,
    draw,
    of_radiance,
    width,
)

N = 1500
LOBES = [("rough", kind) for kind in ROUGH] + [("smooth", kind) for kind in ("plastic", "metal", "trans")]


@pytest.mark.parametrize("source", [0.5, 0.001])
@pytest.mark.parametrize(("surface", "kind"), LOBES)
def test_direct_lobes_agree_with_rtrace(surface, kind, source, radiance, tmp_path):
    make = (ROUGH if surface == "rough" else SMOOTH)[kind]
    case = draw(kind, make, N, seed=11)
    found = compare(radiance, tmp_path, case, source)
    assert found.relative.size > 2 * N
    assert found.relative.max() < 1e-5
    assert found.cut.sum() < 0.05 * found.lit.sum()
    # Even where a lobe is left out, nearly everything lies within 1e-4.
    whole = np.abs(found.ours[found.lit] / np.maximum(found.theirs[found.lit], 1e-30) - 1.0)
    assert (whole > 1e-4).sum() < 0.005 * whole.size
    # Dark where RADIANCE is dark: the far side of an opaque material.
    assert found.ours[~found.lit].sum() == 0.0
    if kind.startswith("trans"):
        assert case.transmitted.sum() > N / 4


def test_a_source_of_finite_size_widens_the_lobes_of_radiance(radiance, tmp_path):
    # Without the widening the comparison above fails where lobes are narrow: no tolerance hides it.
    case = draw("metal", ROUGH["metal"], N, seed=11)
    narrow = np.array([width(p) < 0.05 for p in case.parameters])
    disc = of_radiance(radiance, tmp_path, case, 0.5)
    point = of_radiance(radiance, tmp_path, case, 0.001)
    difference = np.abs(disc / point - 1.0)
    assert difference[narrow].max() > 1e-3


def test_swapped_directions_of_ashik2_do_not_agree(radiance, tmp_path):
    # Its Fresnel factor is of the angle of view: with wi and ws swapped both programs change, and differ.
    case = draw("ashik2", ROUGH["ashik2"], N, seed=11)
    swapped = Case(case.kind, case.parameters, case.u, case.frames, case.ws, case.wi)
    ours = compare(radiance, tmp_path, case, 0.001).theirs
    other = np.array(
        [
            [
                gonio.RadianceMaterial("ashik2", id="m", strings=[*map(repr, map(float, u)), "."], **p)
                .bsdf()
                .eval(
                    **dict(zip(("theta_i", "phi_i", "theta_s", "phi_s"), angles, strict=True)), channel="red"
                )
            ]
            for p, u, angles in zip(swapped.parameters, swapped.u, _angles(swapped), strict=True)
        ]
    )
    assert np.median(np.abs(other / ours[:, :1] - 1.0)) > 0.01


def _angles(case):
    rows = []
    for v in (case.wi, case.ws):
        rows += [
            np.degrees(np.arctan2(np.hypot(v[:, 0], v[:, 1]), v[:, 2])),
            np.degrees(np.arctan2(v[:, 1], v[:, 0])),
        ]
    return np.stack(rows, -1).tolist()


@pytest.mark.parametrize("kind", sorted(SMOOTH))
def test_ideal_parts_agree_with_rtrace(kind, radiance, tmp_path):
    found = compare_ideal(radiance, tmp_path, kind, N, seed=12)
    parts = ["reflection"] if kind in ("plastic", "metal", "mirror") else ["reflection", "transmission"]
    for component in found.ours:
        ours, theirs = found.ours[component], found.theirs[component]
        if component not in parts:
            assert theirs.max() == ours.max() == 0.0
            continue
        assert (ours > 0).sum() > N
        np.testing.assert_allclose(theirs, ours, rtol=1e-4, atol=CUT)


def test_written_materials_mean_the_same_to_radiance(radiance, tmp_path):
    # Written by gonio, expanded by RADIANCE's own reader of scenes, read back by gonio.
    materials = [
        gonio.RadianceMaterial(
            "plastic", id="white 'quoted' paint", red=0.1, green=1e-7, blue=1.0, spec=0.02, rough=1 / 3
        ),
        gonio.RadianceMaterial(
            "metal2", id="m", red=0.9, green=0.8, blue=0.7, spec=0.9, urough=0.05, vrough=0.2
        ),
        gonio.RadianceMaterial("glass", id="g", rtn=0.96, gtn=0.96, btn=0.96, n=1.6),
        gonio.RadianceMaterial("mirror", id="#1", red=0.9, green=0.9, blue=0.9),
    ]
    gonio.write_materials(tmp_path / "a.rad", materials, comment="four")
    expanded = radiance.run("xform", "a.rad", cwd=tmp_path)
    (tmp_path / "b.rad").write_bytes(expanded)
    back = gonio.read_materials(tmp_path / "b.rad")
    assert [m.type for m in back] == [m.type for m in materials]
    for ours, theirs in zip(materials, back, strict=True):
        assert list(theirs.parameters.values()) == pytest.approx(list(ours.parameters.values()), rel=1e-6)
    radiance.run("oconv", "a.rad", cwd=tmp_path)
