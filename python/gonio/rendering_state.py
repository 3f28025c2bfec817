"""Samples of unfinished pictures, kept beside them."""

from __future__ import annotations

import hashlib
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from gonio._native import DomainError, FormatError, Samples
from gonio.files import replacing_file

SUFFIX = ".samples.npz"


@dataclass(frozen=True)
class Job:
    """What samples belong to; `text` is the view or the sensors, `scene` what a few paths bring."""

    kind: str
    width: int
    height: int
    text: str
    seed: int
    bounces: int
    scene: bytes

    def described(self) -> dict[str, str]:
        """Its fields as text, the long ones by their SHA-256."""
        fields = asdict(self)
        fields["scene"] = hashlib.sha256(self.scene).hexdigest()
        if self.kind == "sensors":
            fields["text"] = hashlib.sha256(self.text.encode()).hexdigest()
        return {name: str(value) for name, value in fields.items()}


_NAMES = {"text": "view or sensors", "kind": "picture or sensors"}


def state_path(target: Path) -> Path:
    """The file that keeps the samples of the result `target`."""
    return target.with_name(target.name + SUFFIX)


def save_state(target: Path, job: Job, samples: Samples) -> None:
    """Write the samples beside `target`, whole or not at all."""
    with replacing_file(state_path(target)) as staged, staged.open("wb") as file:
        arrays: dict[str, Any] = samples.to_arrays() | job.described()
        np.savez(file, **arrays)


def resume_or_new(target: Path | None, job: Job, *, resume: bool) -> Samples:
    """The kept samples if they are wanted and there, none otherwise.

    Raises
    ------
    DomainError
        They belong to something else.
    FormatError
        The file is not one of kept samples.
    """
    if target is None or not resume or not state_path(target).exists():
        return Samples(job.width * job.height)
    path = state_path(target)
    try:
        with np.load(path, allow_pickle=False) as kept:
            for name, wanted in job.described().items():
                found = str(kept[name])
                if found != wanted:
                    what = _NAMES.get(name, name)
                    long = len(wanted) > 60
                    raise DomainError(
                        f"{path}: {what}: found {'another' if long else found}, "
                        f"allowed {'the same' if long else wanted}; without resume (--resume) it begins anew"
                    )
            return Samples.from_arrays(
                sum=kept["sum"],
                square=kept["square"],
                count=kept["count"].astype(np.float64),
                goal=int(kept["goal"]),
                floor=float(kept["floor"]),
            )
    except (KeyError, ValueError, EOFError, zipfile.BadZipFile) as error:
        raise FormatError(f"{path}: found no samples of gonio in it, allowed a file that it wrote") from error


def forget(target: Path) -> None:
    """Remove the kept samples of a finished result."""
    state_path(target).unlink(missing_ok=True)
