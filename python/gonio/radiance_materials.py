"""Radiance materials (`.rad` text), read, written and as models; docs/formats/radiance-material.md."""

from __future__ import annotations

from collections.abc import Sequence

from gonio import _native
from gonio._native import Bsdf, DomainError, RadianceMaterial
from gonio.readings import PathLike
from gonio.working import interruptible


def read_materials(path: PathLike) -> list[RadianceMaterial]:
    """Read the materials of a Radiance scene, in order, aliases of materials among them.

    plastic, metal, trans, plastic2, metal2, trans2, ashik2, glass, mirror and dielectric are materials; items
    of other types are passed over.

    Raises
    ------
    FormatError
        The text does not follow the format, a parameter is out of range, or a line is a command (`!`):
        commands are never run. Names file, line and field.
    OSError
        The operating system refuses.
    """
    return interruptible(lambda: _native.read_radiance_materials(path))


def write_materials(
    path: PathLike, materials: RadianceMaterial | Sequence[RadianceMaterial], *, comment: str = ""
) -> None:
    """Write materials as text of a Radiance scene, whole or not at all.

    Parameters
    ----------
    path
        The file; an older one is replaced.
    materials
        One material or several, written in order.
    comment
        Text for the head of the file; every line of it becomes a comment.

    Raises
    ------
    OSError
        The operating system refuses; an older file stays as it was.
    """
    several = [materials] if isinstance(materials, RadianceMaterial) else list(materials)
    _native.write_radiance_materials(path, several, [comment] if comment else [])


def material_of_text(text: str, *, release: str = "6.1", ignore_modifier: bool = False) -> Bsdf:
    """Make the model of the one material in `text`; see `gonio.materials.radiance`."""
    found = _native.parse_radiance_materials(text)
    if len(found) != 1:
        names = ", ".join(m.id for m in found) or "none"
        raise DomainError(f"text: found {len(found)} materials ({names}), allowed one")
    return found[0].bsdf(release=release, ignore_modifier=ignore_modifier)
