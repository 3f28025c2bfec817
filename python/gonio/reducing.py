"""From any model to gonio's compact one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gonio import _native
from gonio._native import Bsdf, Compact, DataDriven, FormatError, QuantityError
from gonio.compact_files import write_compact
from gonio.comparing import ModelComparison, ModelOrMeasurement, compare, model_of, scatters
from gonio.files import check_file
from gonio.measurement import Measurement
from gonio.measurement_header import JSON_NAME
from gonio.provenance import input_file, provenance
from gonio.readings import PathLike
from gonio.working import Progress, interruptible, silent


@dataclass(frozen=True)
class Reduction:
    """A compact model and what it loses.

    Attributes
    ----------
    model
        The compact model.
    loss
        It against the model it was made of.
    out
        The file it was written to, None without one.
    bytes
        Size of the file; without one, bytes of the tables.
    warnings
        What to know of the full model, and of a target that was not reached.
    """

    model: Compact
    loss: ModelComparison
    out: Path | None
    bytes: int
    warnings: list[str]

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as `gonio reduce --json` prints them."""
        return {
            "out": self.out,
            "bytes": self.bytes,
            "bytes_per_channel": {"-".join(k): v for k, v in self.model.bytes_per_channel.items()},
            "error": {"-".join(k): v for k, v in self.model.report["error"].items()},
            "unscattered_error": {"-".join(k): v for k, v in self.model.report["ideal_error"].items()},
            "max_albedo": self.model.report["max_albedo"],
            "loss": self.loss.to_dict(),
            "warnings": self.warnings,
        }


def reduce(
    source: ModelOrMeasurement,
    *,
    out: PathLike | None = None,
    channels: Sequence[str] | None = None,
    components: Sequence[tuple[str, str]] | None = None,
    target: float = 0.005,
    max_bytes: int | None = None,
    bits: int | None = None,
    name: str | None = None,
    direct: bool = True,
    progress: Progress = silent,
) -> Reduction:
    """Reduce a model to the compact one: analytic lobes times a small quantised table of ratios.

    docs/models/compact.md says how, and what it reaches. The compact model is a `Bsdf` as any other, is
    evaluated and sampled fast, and is kept in a file of a few kilobytes that `gonio.read_bsdf` reads.

    Parameters
    ----------
    source
        A model, a file of one, a measurement or the directory of a saved one (its data-driven model then).
    out
        File to write, docs/formats/gonio-compact.md.
    channels
        Channels to keep; None keeps all.
    components
        Side of incidence and component to keep, for example ("front", "reflection"); None keeps all that
        scatter.
    target
        Relative L1 error, mean over incidences, at which a table is fine enough, 0.0001 to 1.
    max_bytes
        Most bytes of the table of one channel of a component as stored; None is 16 000 for isotropic models
        and 400 000 for others. Where they do not suffice for the target, the error is what they give, and
        `warnings` says so.
    bits
        Bits of a value, 8 or 16, the range of every incidence divided evenly; None takes the step that gives
        the least error within the bytes.
    name
        Name of the material; the sample's unless given.
    direct
        For a measurement: whether peaks as narrow as the beam become unscattered light (`gonio.build`).
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    DomainError
        An option out of range; an ideal part that bends light, which the model cannot hold; nothing scatters.
    QuantityError
        A channel that is not there; a component in which the model does not scatter.
    FormatError
        `out` is the file that is read.
    FitError, FormatError, OSError
        A measurement that no model can be built from, a file that cannot be read or written; nothing is left
        behind.
    """
    if out is not None:
        check_file(out)
        _require_other(out, source)
    sample, origin = _opened(source)
    wanted = list(channels) if channels is not None else None
    one = wanted[0] if wanted is not None and len(wanted) == 1 else None
    full = model_of(sample, channel=one, direct=direct, progress=progress)
    dark = ["-".join(k) for k in components or () if not scatters(full, *k)]
    if dark:
        raise QuantityError(f"components: found {', '.join(dark)}, where the model does not scatter")
    progress("reducing", 0, 1)
    model = interruptible(
        lambda: _native.to_compact(
            full,
            channels=wanted,
            components=list(components) if components is not None else None,
            target=target,
            max_bytes=max_bytes,
            bits=bits,
        )
    )
    progress("reducing", 1, 1)
    loss = _loss(full, model, progress)
    size = sum(model.bytes_per_channel.values()) * len(model.channels)
    written = None
    if out is not None:
        written = Path(out)
        title = (
            name if name is not None else (sample.sample_name if isinstance(sample, Measurement) else None)
        )
        settings = {"target": target, "max_bytes": max_bytes, "bits": bits, "channels": wanted}
        write_compact(
            written, model, name=title or "", provenance=provenance(inputs=origin, settings=settings)
        )
        size = written.stat().st_size
    notes = list(full.warnings) if isinstance(full, DataDriven) else []
    notes += _missed(model, target)
    return Reduction(model=model, loss=loss, out=written, bytes=size, warnings=notes)


def _missed(model: Compact, target: float) -> list[str]:
    """Components whose table did not reach the target, in words."""
    out = []
    for (side, component), errors in model.report["error"].items():
        if max(errors) > target:
            size = model.bytes_per_channel[side, component]
            out.append(
                f"{side} {component}: {100 * max(errors):.2f} % relative L1 with {size} bytes of a channel; "
                f"the target of {100 * target:.4g} % was not reached; it needs more bytes (--max-bytes)"
            )
    return out


def _require_other(out: PathLike, source: ModelOrMeasurement) -> None:
    """Refuse to write over the file that is read."""
    if isinstance(source, (Bsdf, Measurement)) or not Path(out).exists() or not Path(source).exists():
        return
    if Path(out).samefile(source):
        raise FormatError(f"{out}: is the model that is reduced, another file is needed")


def _opened(source: ModelOrMeasurement) -> tuple[Bsdf | Measurement | PathLike, list[dict[str, Any]]]:
    """The source, loaded where it is the directory of a measurement, and the file it comes from."""
    if isinstance(source, Bsdf):
        return source, []
    if isinstance(source, Measurement):
        return source, [{"name": source.sample_name, "role": "measurement"}]
    path = Path(source)
    if path.is_dir():
        return Measurement.load(path), [input_file(path / JSON_NAME, role="measurement")]
    return source, [input_file(path, role="model")]


def _loss(full: Bsdf, model: Compact, progress: Progress) -> ModelComparison:
    """The compact model against the full one, in the channels and components that it has."""
    parts = [
        compare(full, model, channel=c, components=model.components, progress=progress)
        for c in model.channels
    ]
    return ModelComparison(
        rows=[row for part in parts for row in part.rows],
        a=full,
        b=model,
        channels=[pair for part in parts for pair in part.channels],
        warnings=list(dict.fromkeys(text for part in parts for text in part.warnings)),
    )
