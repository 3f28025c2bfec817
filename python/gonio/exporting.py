"""From a measurement or a model to the files of other programs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet as pq

from gonio import _native, bird
from gonio._native import Bsdf, DomainError, QuantityError, Scan, Slice
from gonio.building import build
from gonio.checking import MeasurementOrPath, loaded
from gonio.comparing import PHI_I, THETA_I
from gonio.files import check_directory, replacing_directory, replacing_file
from gonio.measurement import Measurement
from gonio.model_files import read_bsdf
from gonio.model_writers import MODEL_WRITERS, Target
from gonio.readings import PathLike
from gonio.working import Progress, interruptible, silent

RADIANCE_FORMATS = ("radiance-klems", "radiance-ttree")
MODEL_FORMATS = (*RADIANCE_FORMATS, "rgl-bsdf", "merl", "zemax-bsdf")
TABLE_FORMATS = ("csv", "parquet", "netcdf", "bird-json")
FORMATS = (*MODEL_FORMATS, *TABLE_FORMATS, "mountain")

MOUNTAIN_INDEX = "index.csv"
"""Names the incidence and channel of each file of a Mountain export; marks the directory as one."""

LOSS_THETA_I = THETA_I
"""Degrees from the normal of the lit side: the incidences at which an export is compared with its model."""

Component = tuple[str, str]
"""Side of incidence (front, back) and component (reflection, transmission)."""


@dataclass(frozen=True)
class Export:
    """What was written where, and what the reduction of the model found and lost (empty for tables).

    `report["loss"]` maps (side, component) to a dict of the comparison with the full model at the incidences
    `LOSS_THETA_I`: rel_l1 (mean) and rel_l1_max of the integral of |df| cos over that of f cos of the
    scattered light, ideal and ideal_model (means of the share of the light without spread: of a table, what
    its cells in the ideal direction hold), ideal_difference (where they differ most),
    dhr_difference, the directional albedo of the reduced model less that of the full one where they differ
    most, peak_ratio, the greatest value of the reduced model over that of the full one where they differ
    most, reciprocity and reciprocity_model, the mean relative difference of f from f with the directions
    swapped (NaN where nothing is known of light that comes the other way).
    NaN where the model does not scatter.
    """

    to: str
    out: Path
    report: dict[str, Any] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)


def export(
    source: MeasurementOrPath | Bsdf,
    *,
    to: str,
    out: PathLike,
    channel: str | None = None,
    symmetry: str = "auto",
    smooth: bool = True,
    candidate: str | None = None,
    components: Sequence[Component] | None = None,
    basis: str = "full",
    cap_albedo: bool = False,
    rank: int | None = None,
    max_depth: int | None = None,
    target: float | None = None,
    max_bytes: int | None = None,
    name: str | None = None,
    manufacturer: str = "",
    thickness: float | None = None,
    as_visible: bool = False,
    force: bool = False,
    progress: Progress = silent,
) -> Export:
    """Write a measurement or a model in the format of another program, whole or not at all.

    The Radiance formats, rgl-bsdf, merl and zemax-bsdf hold a model: of a measurement the data-driven one
    that `gonio.build` makes, which takes at least two incidences. The others hold the readings. Light that
    leaves unscattered goes to its own patches in radiance-klems, to the finest cells in radiance-ttree;
    elsewhere it stays in the BSDF of a measurement as the instrument saw it.

    Parameters
    ----------
    source
        A measurement, the directory of a saved one, or (for the formats that hold one) any model or a file
        that `gonio.read_bsdf` reads.
    to
        radiance-klems and radiance-ttree (BSDF XML; of a measurement the data-driven model), rgl-bsdf
        (reflection, for `measured` of Mitsuba 3), merl (isotropic reflection in red, green and blue),
        zemax-bsdf (one channel and component), csv, parquet and netcdf (the columns of docs/data-model.md),
        bird-json (reflection), mountain (a directory with one text file a slice).
    out
        The file, or the directory for mountain.
    channel
        The channel; needed for the Radiance formats and zemax-bsdf where there are several, takes one out for
        the others; rgl-bsdf and merl are written grey from it.
    symmetry
        Symmetry of the data-driven model, as in `gonio.build`.
    smooth, candidate
        Smoothing and interpolation of the data-driven model, as in `gonio.build`.
    components
        Side of incidence and component of what a Radiance file holds, for example ("front", "reflection");
        None takes all that scatter. rgl-bsdf, merl and zemax-bsdf hold one, front reflection unless given.
    basis
        Patches of radiance-klems: full, half or quarter.
    cap_albedo
        Scale patches of radiance-klems with an albedo above 1 back to 1; the report names them.
    rank
        Rank of radiance-ttree: 3 (isotropic), 4, or None for what the model needs.
    max_depth
        Finest cells of radiance-ttree: 2**-max_depth of the square's side; None is 8.
    target
        Relative L1 error at which the refinement of radiance-ttree stops, mean over incidences; None is 0.03,
        or 0 with `max_bytes`.
    max_bytes
        Bytes of each component's data at which the refinement of radiance-ttree stops (the rest of the file
        takes about 1 kB); None sets no limit but 40,000 cells.
    name, manufacturer, thickness
        Metadata of a Radiance file, thickness in metres; the name is the sample's unless given.
    as_visible
        Label the data of a Radiance file Visible whatever their channel: Radiance renders nothing else.
    force
        Write a mountain directory over other files.
    progress
        Called with stage, parts done and parts in all.

    Raises
    ------
    DomainError
        An option outside its choices.
    QuantityError
        A channel that is not there or not named among several; a component that was not measured; a table of
        a model.
    FitError
        A measurement that no model can be built from.
    FormatError
        A saved measurement is damaged, or the format has no word for the channel.
    OSError
        The operating system refuses; nothing is left behind.
    """
    if to not in FORMATS:
        raise DomainError(f"to: found {to!r}, allowed {', '.join(FORMATS)}")
    target_path = Path(out)
    if not isinstance(source, (Bsdf, Measurement)) and Path(source).is_file():
        source = read_bsdf(source, channel=channel)
    if to in MODEL_FORMATS:
        sample = None if isinstance(source, Bsdf) else loaded(source)
        _check_label(to, channel, sample or source, as_visible=as_visible)
        model = (
            source
            if isinstance(source, Bsdf)
            else build(
                sample or source,
                channel=channel,
                symmetry=symmetry,
                smooth=smooth,
                candidate=candidate,
                progress=progress,
            )
        )
        _check_measured(model, components or ())
        if to in MODEL_WRITERS:
            progress("reducing", 0, 1)
            notes = list(model.warnings) if isinstance(model, _native.DataDriven) else []
            title = name if name is not None else (sample.sample_name if sample else None) or ""
            file = Target(path=target_path, channel=channel, components=components, title=title)
            report, more = MODEL_WRITERS[to](model, file)
            if model.has_delta and not any("left out" in note for note in more):
                more = [*more, f"{to} has no word for light that leaves unscattered: it is not in the file"]
            if "reduced" in report:
                taken = report.pop("channel")
                report["loss"] = _loss(model, report.pop("reduced"), taken, (("front", "reflection"),))
            progress("reducing", 1, 1)
            return Export(to=to, out=target_path, report=report, warnings=notes + more)
        shared: dict[str, Any] = {"components": components, "channel": channel}
        progress("reducing", 0, 1)
        reduced: _native.Klems | _native.TensorTree
        if to == "radiance-klems":
            reduced = interruptible(
                lambda: _native.to_klems(model, basis=basis, cap_albedo=cap_albedo, **shared)
            )
        else:
            reduced = interruptible(
                lambda: _native.to_tensor_tree(
                    model, rank=rank, max_depth=max_depth, target=target, max_bytes=max_bytes, **shared
                )
            )
        progress("reducing", 1, 1)
        report = dict(reduced.report) | {"loss": _loss(model, reduced, channel, reduced.components)}
        title = name if name is not None else (sample.sample_name if sample else None) or ""
        _native.write_radiance_xml(
            target_path,
            reduced,
            name=title,
            manufacturer=manufacturer,
            thickness=thickness,
            as_visible=as_visible,
        )
        notes = list(model.warnings) if isinstance(model, _native.DataDriven) else []
        if model.has_delta:
            notes.append(
                "patches or cells in the mirror and through directions hold light that leaves unscattered: "
                "name the file in an aBSDF material and Radiance shows what is behind it sharp"
            )
        if not as_visible and (label := reduced.channels[0]) != "photopic":
            notes.append(
                f"the data are labelled {label}, and Radiance renders what is labelled Visible only: "
                "--as-visible (as_visible=True) labels them so"
            )
        return Export(to=to, out=target_path, report=report, warnings=notes)
    if isinstance(source, Bsdf):
        raise QuantityError(f"source: found a model, needed a measurement to write {to}")
    measurement = _of_channel(loaded(source), channel)
    progress("writing", 0, 1)
    if to == "mountain":
        _write_mountain(measurement, target_path, force=force)
    notes = [] if to == "mountain" else _TABLES[to](measurement, target_path) or []
    progress("writing", 1, 1)
    return Export(to=to, out=target_path, warnings=notes)


def read_radiance(path: PathLike, *, channel: str = "photopic") -> Bsdf:
    """Read one channel of a Radiance or WINDOW BSDF XML file as a model.

    Parameters
    ----------
    path
        The XML file: Klems matrices (full, half, quarter) or a tensor tree of rank 3 or 4.
    channel
        photopic is the file's Visible, solar its Solar, 550nm a wavelength.

    Raises
    ------
    FormatError
        The file does not follow the format, or has no such channel.
    OSError
        The operating system refuses.
    """
    return interruptible(lambda: _native.read_radiance_xml(path, channel=channel))


def _loss(
    model: Bsdf, reduced: Bsdf, channel: str | None, components: Sequence[Component]
) -> dict[Component, dict[str, float]]:
    """What the reduced model loses, by component; see `Export`."""
    # the azimuths of `compare`
    isotropic = model.properties["isotropic"] and reduced.properties["isotropic"]
    phi_i = (0.0,) if isotropic else PHI_I
    losses: dict[Component, dict[str, float]] = {}
    for side, component in components:
        names = [channel or model.channels[0], reduced.channels[0]]
        if channel in reduced.channels:
            names[1] = names[0]
        at, swapped = [], []
        for theta in LOSS_THETA_I:
            theta_i = theta if side == "front" else 180.0 - theta
            for phi in phi_i:
                at.append(
                    _native.reduction_loss(
                        model, reduced, theta_i=theta_i, phi_i=phi, component=component, channel=channel
                    )
                )
                swapped.append(
                    _native.compare_models(
                        model,
                        reduced,
                        theta_i=theta_i,
                        phi_i=phi,
                        component=component,
                        channel_a=names[0],
                        channel_b=names[1],
                    )
                )
        rel_l1 = [one["rel_l1"] for one in at if math.isfinite(one["rel_l1"])]
        differences = [one["albedo_reduced"] - one["albedo_model"] for one in at]
        peaks = [one["peak_ratio"] for one in at if one["peak_ratio"] > 0]
        losses[side, component] = {
            "rel_l1": _mean(rel_l1),
            "rel_l1_max": max(rel_l1, default=math.nan),
            "dhr_difference": max(differences, key=abs),
            "peak_ratio": max(peaks, key=lambda ratio: abs(math.log(ratio)), default=math.nan),
            "ideal": _mean([one["ideal_reduced"] for one in at]),
            "ideal_model": _mean([one["ideal_model"] for one in at]),
            "ideal_difference": max((one["ideal_reduced"] - one["ideal_model"] for one in at), key=abs),
            "reciprocity": _mean([one["reciprocity_b"] for one in swapped]),
            "reciprocity_model": _mean([one["reciprocity_a"] for one in swapped]),
        }
    return losses


def _mean(values: Sequence[float]) -> float:
    """Mean of the finite ones, NaN without any."""
    finite = [v for v in values if math.isfinite(v)]
    return sum(finite) / len(finite) if finite else math.nan


def _check_label(to: str, channel: str | None, source: object, *, as_visible: bool) -> None:
    """Refuse channels that Radiance's files have no word for, before the model is built."""
    there: Sequence[str] = getattr(source, "channels", ())
    label = channel if channel is not None else there[0] if len(there) == 1 else None
    if to in RADIANCE_FORMATS and not as_visible and label in ("red", "green", "blue"):
        raise QuantityError(
            f"channel: found {label}, allowed photopic, solar or a wavelength; --as-visible "
            "(as_visible=True) labels it Visible, which Radiance renders: one file a channel, coloured by "
            "its material"
        )


def _check_measured(model: Bsdf, components: Sequence[Component]) -> None:
    """Refuse components that a data-driven model knows nothing of: it answers 0 for them."""
    if not isinstance(model, _native.DataDriven):
        return
    measured = [(part["side"], part["component"]) for part in model.summary]
    for side, component in components:
        known = side in ("front", "back") and component in ("reflection", "transmission")
        if known and (side, component) not in measured:
            there = ", ".join(dict.fromkeys("-".join(m) for m in measured))
            raise QuantityError(
                f"component: found {side}-{component}, which was not measured, needed one of {there}"
            )


def _of_channel(measurement: Measurement, channel: str | None) -> Measurement:
    """The slices of one channel with everything else of the measurement."""
    if channel is None:
        return measurement
    wanted = {channel, f"{channel}nm"}
    slices = [s for s in measurement.slices if s.channel in wanted]
    if not slices:
        raise QuantityError(f"channel: found {channel}, needed one of {', '.join(measurement.channels)}")
    return Measurement(
        slices,
        sample_name=measurement.sample_name,
        signature_fwhm=measurement.signature_fwhm,
        resolutions=[r for r in measurement.resolutions if r.channel in wanted],
        warnings=measurement.warnings,
        provenance=measurement.provenance,
        findings=measurement.findings,
    )


def _write_csv(measurement: Measurement, path: Path) -> None:
    table = measurement.to_table()
    column = table.schema.get_field_index("channel")
    table = table.set_column(column, "channel", table["channel"].cast(pa.string()))
    with replacing_file(path) as staged:
        pyarrow.csv.write_csv(table, staged)


def _write_parquet(measurement: Measurement, path: Path) -> None:
    with replacing_file(path) as staged:
        pq.write_table(measurement.to_table(), staged, compression="zstd")


_TABLES: dict[str, Callable[[Measurement, Path], list[str] | None]] = {
    "csv": _write_csv,
    "parquet": _write_parquet,
    "netcdf": lambda measurement, path: measurement.to_netcdf(path),
    bird.FORMAT: lambda measurement, path: bird.write(path, measurement),
}


def _write_mountain(measurement: Measurement, path: Path, *, force: bool) -> None:
    check_directory(path, marker=MOUNTAIN_INDEX, force=force)
    with replacing_directory(path, marker=MOUNTAIN_INDEX, owned=("slice_*.txt",), force=force) as staged:
        rows = ["file,channel,theta_i,phi_i"]
        for k, s in enumerate(measurement.slices):
            file = f"slice_{k:03d}_{s.channel}_theta{s.theta_i:05.1f}_phi{s.phi_i:05.1f}.txt"
            _native.write_mountain(staged / file, _scan(s, measurement.sample_name))
            rows.append(f"{file},{s.channel},{s.theta_i!r},{s.phi_i!r}")
        (staged / MOUNTAIN_INDEX).write_text("\n".join(rows) + "\n", encoding="utf-8")


def _scan(s: Slice, sample_name: str | None) -> Scan:
    """The usable readings of a slice as a scan of DSF values."""
    usable = (s.flags & _native.UNUSABLE) == 0
    return Scan(
        quantity="dsf",
        channel=s.channel,
        theta_i=s.theta_i,
        phi_i=s.phi_i,
        theta_s=s.theta_s[usable],
        phi_s=s.phi_s[usable],
        value=s.dsf[usable],
        meta={"sample_name": sample_name} if sample_name else None,
    )
