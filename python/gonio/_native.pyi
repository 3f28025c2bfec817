"""Types of the native core. Angles are degrees, arrays are copies."""

from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from typing import Any, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str
FLAGS: dict[str, int]
UNUSABLE: int

class GonioError(Exception): ...
class FormatError(GonioError): ...
class QuantityError(GonioError): ...
class DomainError(GonioError): ...
class FitError(GonioError): ...

def read_file(
    path: str | PathLike[str],
    format: str | None = None,
    *,
    kind: str | None = None,
    quantity: str | None = None,
    channel: str | None = None,
    upphi: float | None = None,
    columns: Mapping[str, str] | None = None,
) -> list[Scan]: ...
def read_mueller(path: str | PathLike[str]) -> list[tuple[Scan, NDArray[np.float64]]]: ...
def detect_format(path: str | PathLike[str]) -> str: ...
def write_mountain(path: str | PathLike[str], scan: Scan) -> None: ...
def write_raw(path: str | PathLike[str], scans: Sequence[Scan]) -> None: ...

@final
class Scan:
    def __init__(
        self,
        *,
        kind: str = "sample",
        quantity: str = "signal",
        channel: str = "photopic",
        theta_i: float,
        phi_i: float,
        theta_s: ArrayLike,
        phi_s: ArrayLike,
        value: ArrayLike,
        time: ArrayLike | None = None,
        meta: Mapping[str, Any] | None = None,
    ) -> None: ...
    @property
    def kind(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def channel(self) -> str: ...
    @property
    def theta_i(self) -> float: ...
    @property
    def phi_i(self) -> float: ...
    @property
    def theta_s(self) -> NDArray[np.float64]: ...
    @property
    def phi_s(self) -> NDArray[np.float64]: ...
    @property
    def value(self) -> NDArray[np.float64]: ...
    @property
    def time(self) -> NDArray[np.float64] | None: ...
    @property
    def meta(self) -> dict[str, Any]: ...
    def __len__(self) -> int: ...

@final
class HemisphericalIntegral:
    def __init__(
        self, *, side: str, value: float, extrapolated: float, u: float, u_quadrature: float
    ) -> None: ...
    @property
    def side(self) -> Literal["front", "back"]: ...
    @property
    def value(self) -> float: ...
    @property
    def extrapolated(self) -> float: ...
    @property
    def u(self) -> float: ...
    @property
    def u_quadrature(self) -> float: ...

@final
class Resolution:
    def __init__(
        self,
        *,
        channel: str,
        fwhm: float,
        radius_50: float,
        radius_90: float,
        second_moment: float,
        receiver_radius: float | None = None,
        spot_radius: float | None = None,
    ) -> None: ...
    @property
    def channel(self) -> str: ...
    @property
    def fwhm(self) -> float: ...
    @property
    def radius_50(self) -> float: ...
    @property
    def radius_90(self) -> float: ...
    @property
    def second_moment(self) -> float: ...
    @property
    def receiver_radius(self) -> float | None: ...
    @property
    def spot_radius(self) -> float | None: ...

@final
class Slice:
    def __init__(
        self,
        *,
        theta_i: float,
        phi_i: float,
        channel: str,
        theta_s: ArrayLike,
        phi_s: ArrayLike,
        dsf: ArrayLike,
        u_dsf: ArrayLike,
        omega: ArrayLike,
        flags: NDArray[np.uint16],
        u_common: float = 0.0,
        integrals: Sequence[HemisphericalIntegral] = (),
    ) -> None: ...
    @property
    def theta_i(self) -> float: ...
    @property
    def phi_i(self) -> float: ...
    @property
    def channel(self) -> str: ...
    @property
    def theta_s(self) -> NDArray[np.float64]: ...
    @property
    def phi_s(self) -> NDArray[np.float64]: ...
    @property
    def dsf(self) -> NDArray[np.float64]: ...
    @property
    def bsdf(self) -> NDArray[np.float64]: ...
    @property
    def u_dsf(self) -> NDArray[np.float64]: ...
    @property
    def omega(self) -> NDArray[np.float64]: ...
    @property
    def flags(self) -> NDArray[np.uint16]: ...
    @property
    def u_common(self) -> float: ...
    @property
    def integrals(self) -> list[HemisphericalIntegral]: ...
    def highest(self, side: str) -> tuple[tuple[float, float], float, float, float] | None: ...
    def __len__(self) -> int: ...

@final
class MeasurementData:
    def __init__(
        self,
        slices: Sequence[Slice],
        *,
        sample_name: str | None = None,
        signature_fwhm: float | None = None,
        resolutions: Sequence[Resolution] = (),
        warnings: Sequence[str] = (),
    ) -> None: ...
    def annotated(
        self, *, sample_name: str | None = None, warnings: Sequence[str] = ()
    ) -> MeasurementData: ...
    @property
    def slices(self) -> list[Slice]: ...
    @property
    def sample_name(self) -> str | None: ...
    @property
    def signature_fwhm(self) -> float | None: ...
    @property
    def resolutions(self) -> list[Resolution]: ...
    @property
    def warnings(self) -> list[str]: ...
    @property
    def processing(self) -> dict[str, list[Any]]: ...
    @property
    def findings(self) -> list[Verdict]: ...

@final
class Verdict:
    def __init__(
        self,
        *,
        id: str,
        title: str,
        verdict: str,
        sentence: str,
        value: float | None = None,
        unit: str = "",
    ) -> None: ...
    @property
    def id(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def verdict(self) -> Literal["pass", "warn", "fail", "info"]: ...
    @property
    def value(self) -> float | None: ...
    @property
    def unit(self) -> str: ...
    @property
    def sentence(self) -> str: ...
    def to_dict(self) -> dict[str, Any]: ...

class Bsdf:
    @property
    def channels(self) -> list[str]: ...
    @property
    def has_delta(self) -> bool: ...
    @property
    def properties(self) -> dict[str, bool]: ...
    def eval(
        self,
        *,
        theta_i: ArrayLike,
        phi_i: ArrayLike,
        theta_s: ArrayLike,
        phi_s: ArrayLike,
        channel: str | None = None,
    ) -> NDArray[np.float64]: ...
    def has_data(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, theta_s: ArrayLike, phi_s: ArrayLike
    ) -> NDArray[np.bool_]: ...
    def pdf(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, theta_s: ArrayLike, phi_s: ArrayLike
    ) -> NDArray[np.float64]: ...
    def delta(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, component: str, channel: str | None = None
    ) -> dict[str, NDArray[np.float64]]: ...
    def sample(self, *, theta_i: float, phi_i: float, u: ArrayLike) -> dict[str, NDArray[Any]]: ...
    @overload
    def eval_directions(
        self, *, wi: ArrayLike, ws: NDArray[np.float32], out: NDArray[np.float32] | None = None
    ) -> NDArray[np.float32]: ...
    @overload
    def eval_directions(
        self, *, wi: ArrayLike, ws: ArrayLike, out: NDArray[np.float64] | None = None
    ) -> NDArray[np.float64]: ...
    @overload
    def sample_directions(
        self, *, wi: ArrayLike, u: NDArray[np.float32]
    ) -> dict[str, NDArray[np.float32]]: ...
    @overload
    def sample_directions(self, *, wi: ArrayLike, u: ArrayLike) -> dict[str, NDArray[np.float64]]: ...

class RadianceMaterial:
    def __init__(
        self,
        type: str,
        *,
        id: str,
        strings: Sequence[str] | None = None,
        modifier: str = "void",
        **parameters: float,
    ) -> None: ...
    @property
    def type(self) -> str: ...
    @property
    def id(self) -> str: ...
    @property
    def modifier(self) -> str: ...
    @property
    def line(self) -> int: ...
    @property
    def parameters(self) -> dict[str, float]: ...
    @property
    def strings(self) -> list[str]: ...
    @property
    def text(self) -> str: ...
    def bsdf(self, *, release: str = "6.1", ignore_modifier: bool = False) -> Bsdf: ...

def read_radiance_materials(path: str | PathLike[str]) -> list[RadianceMaterial]: ...
def parse_radiance_materials(content: str) -> list[RadianceMaterial]: ...
def write_radiance_materials(
    path: str | PathLike[str], materials: Sequence[RadianceMaterial], comments: Sequence[str]
) -> None: ...

class DataDriven(Bsdf):
    @property
    def loo(self) -> list[dict[str, Any]]: ...
    @property
    def loo_error(self) -> float | None: ...
    @property
    def summary(self) -> list[dict[str, Any]]: ...
    @property
    def direct(self) -> list[dict[str, Any]]: ...
    @property
    def warnings(self) -> list[str]: ...
    def coverage(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, theta_s: ArrayLike, phi_s: ArrayLike
    ) -> NDArray[np.uint8]: ...
    def uncertainty(
        self, *, theta_i: ArrayLike, phi_i: ArrayLike, theta_s: ArrayLike, phi_s: ArrayLike
    ) -> dict[str, NDArray[np.float64]]: ...
    def stated_error(
        self, *, theta_i: float, phi_i: float, component: str = "reflection"
    ) -> dict[str, Any] | None: ...
    def albedo(self, *, theta_i: float, phi_i: float) -> float: ...

class BuildWatch:
    def __init__(self) -> None: ...
    def progress(self) -> tuple[str, int, int]: ...
    def stop(self) -> None: ...

def build(
    measurement: MeasurementData,
    *,
    channel: str | None = None,
    symmetry: str = "auto",
    smooth: bool = True,
    candidate: str | None = None,
    direct: bool = True,
    watch: BuildWatch | None = None,
) -> DataDriven: ...
def analytic(parts: Sequence[Mapping[str, Any]]) -> Bsdf: ...
def model_families() -> list[dict[str, Any]]: ...
def directional_albedo(
    model: Bsdf, *, theta_i: float, phi_i: float, component: str, channel: str | None = None
) -> float: ...
def simulate(
    model: Bsdf,
    *,
    incidences: Sequence[tuple[float, float]],
    components: Sequence[str],
    seed: int,
    sample_name: str | None = None,
    started: str | None = None,
    settings: Mapping[str, float],
    parts: Mapping[str, Any] | None = None,
    beam_scans: int = 3,
    watch: Callable[[int, int], None] | None = None,
) -> list[Scan]: ...
def plan(
    model: Bsdf,
    *,
    incidences: Sequence[tuple[float, float]],
    components: Sequence[str],
    seed: int,
    settings: Mapping[str, float],
    parts: Mapping[str, Any],
    beam_scans: int,
    target_integral: float,
    target_peak: float,
    seconds: float | None,
    largest_pitch: float,
    u_calibration: float,
    regions: Sequence[tuple[float, float, float, float]],
    watch: Callable[[int, int], None],
) -> dict[str, Any]: ...
def process(
    sample: Sequence[Scan],
    *,
    beam: Sequence[Scan] = (),
    dark: Sequence[Scan] = (),
    dark_method: str = "auto",
    dark_tolerance: float = 0.25,
    noise_readout: float | None = None,
    noise_relative: float | None = None,
    u_angle: float = 0.0,
    u_calibration: float = 0.0,
    shadow_radius: float | None = None,
) -> MeasurementData: ...
def check(
    measurement: MeasurementData, *, isotropic: bool | None = None, aligned: bool = False
) -> list[Verdict]: ...
def reciprocity(
    measurement: MeasurementData, *, channels: Sequence[str], isotropic: bool | None = None
) -> Verdict: ...
def repeatability(measurements: Sequence[MeasurementData]) -> Verdict: ...
def process_relative(
    sample: Sequence[Scan],
    *,
    standard: Sequence[Scan],
    reflectance_factor: Sequence[float],
    reference_theta: Sequence[float] = (0.0,),
    u_standard: float = 0.0,
    dark: Sequence[Scan] = (),
    dark_method: str = "auto",
    dark_tolerance: float = 0.25,
    noise_readout: float | None = None,
    noise_relative: float | None = None,
    u_angle: float = 0.0,
    u_calibration: float = 0.0,
    shadow_radius: float | None = None,
) -> MeasurementData: ...
def align(measurement: MeasurementData) -> dict[str, float]: ...
def correct_alignment(measurement: MeasurementData) -> MeasurementData: ...
def hemisphere_weights(
    theta_s: ArrayLike, phi_s: ArrayLike, *, side: str
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]: ...
def hemisphere_integral(
    theta_s: ArrayLike,
    phi_s: ArrayLike,
    dsf: ArrayLike,
    *,
    side: str,
    incidence: tuple[float, float] | None = None,
    u_dsf: ArrayLike | None = None,
    reach: float | None = None,
) -> dict[str, float]: ...

class Klems(Bsdf):
    components: list[tuple[str, str]]
    report: dict[str, Any]
    material: dict[str, Any]
    def matrix(self, *, side: str = "front", component: str = "reflection") -> NDArray[np.float32]: ...
    def bases(self, *, side: str = "front", component: str = "reflection") -> tuple[str, str]: ...
    def albedo(self, *, side: str = "front", component: str = "reflection") -> NDArray[np.float64]: ...
    @property
    def max_albedo(self) -> float: ...

class TensorTree(Bsdf):
    components: list[tuple[str, str]]
    report: dict[str, Any]
    material: dict[str, Any]
    rank: int
    cells: int
    def albedo(self, *, theta_i: float, phi_i: float = 0.0, component: str = "reflection") -> float: ...
    @property
    def max_albedo(self) -> float: ...

@final
class Compact(Bsdf):
    components: list[tuple[str, str]]
    report: dict[str, Any]
    bytes_per_channel: dict[tuple[str, str], int]
    def parts(self) -> list[dict[str, Any]]: ...
    def ideal_parts(self) -> list[dict[str, Any]]: ...

def to_compact(
    bsdf: Bsdf,
    *,
    channels: Sequence[str] | None = None,
    components: Sequence[tuple[str, str]] | None = None,
    target: float | None = None,
    max_bytes: int | None = None,
    bits: int | None = None,
) -> Compact: ...
def compact_of(
    channels: Sequence[str],
    parts: Sequence[Mapping[str, Any]],
    *,
    energy_conserving: bool,
    ideal: Sequence[Mapping[str, Any]] | None = None,
) -> Compact: ...
def side_by_side(models: Sequence[Bsdf]) -> Bsdf: ...
def compare_models(
    a: Bsdf,
    b: Bsdf,
    *,
    theta_i: float,
    phi_i: float = 0.0,
    component: str = "reflection",
    channel_a: str | None = None,
    channel_b: str | None = None,
) -> dict[str, float]: ...
def model_reciprocity(
    bsdf: Bsdf,
    *,
    theta_i: float,
    phi_i: float = 0.0,
    component: str = "reflection",
    channel: str | None = None,
) -> float: ...
def largest_albedo(bsdf: Bsdf) -> dict[str, Any]: ...
def read_radiance_xml(path: str | PathLike[str], *, channel: str = "photopic") -> Klems | TensorTree: ...
def radiance_xml_channels(path: str | PathLike[str]) -> list[str]: ...
def to_klems(
    bsdf: Bsdf,
    *,
    basis: str = "full",
    components: Sequence[tuple[str, str]] | None = None,
    channel: str | None = None,
    tolerance: float = 0.0001,
    cap_albedo: bool = False,
) -> Klems: ...
def to_tensor_tree(
    bsdf: Bsdf,
    *,
    rank: int | None = None,
    components: Sequence[tuple[str, str]] | None = None,
    channel: str | None = None,
    max_depth: int | None = None,
    target: float | None = None,
    max_cells: int | None = None,
    max_bytes: int | None = None,
) -> TensorTree: ...
def write_radiance_xml(
    path: str | PathLike[str],
    bsdf: Klems | TensorTree,
    *,
    name: str = "",
    manufacturer: str = "",
    device_type: str = "Other",
    thickness: float | None = None,
    width: float | None = None,
    height: float | None = None,
    as_visible: bool = False,
) -> None: ...
def reduction_loss(
    bsdf: Bsdf,
    reduced: Bsdf,
    *,
    theta_i: float,
    phi_i: float = 0.0,
    component: str = "reflection",
    channel: str | None = None,
    grid: int = 200,
) -> dict[str, float]: ...

@final
class FitData:
    @property
    def model(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def channels(self) -> list[str]: ...
    @property
    def estimates(self) -> list[dict[str, Any]]: ...
    @property
    def correlation(self) -> list[list[float]]: ...
    @property
    def covariance(self) -> list[list[float]]: ...
    @property
    def other_metrics(self) -> dict[str, list[float]]: ...
    @property
    def residuals(self) -> list[dict[str, Any]]: ...
    @property
    def predicted(self) -> list[NDArray[np.float64]]: ...
    @property
    def figures(self) -> dict[str, Any]: ...
    @property
    def albedo(self) -> dict[str, Any] | None: ...
    @property
    def warnings(self) -> list[tuple[str, str]]: ...
    @property
    def sphere(self) -> list[dict[str, Any]]: ...
    @property
    def parameters(self) -> dict[str, dict[str, float]]: ...
    @property
    def parts(self) -> list[dict[str, Any]]: ...
    def bsdf(self) -> Bsdf: ...

def fit_sphere(*, model: str, settings: Mapping[str, Any]) -> FitData: ...
def fit(measurement: MeasurementData, *, model: str, settings: Mapping[str, Any]) -> FitData: ...
def held_out(
    measurement: MeasurementData, fit: FitData, *, settings: Mapping[str, Any]
) -> list[dict[str, Any]]: ...
def select(
    measurement: MeasurementData, *, models: Sequence[str], settings: Mapping[str, Any]
) -> dict[str, Any]: ...
def fit_models() -> list[dict[str, Any]]: ...
def fit_model_bsdf(model: str, parameters: Mapping[str, Mapping[str, float]]) -> Bsdf: ...

@final
class Rgl(Bsdf):
    @property
    def description(self) -> str: ...
    @property
    def theta_i(self) -> NDArray[np.float64]: ...
    @property
    def measured_theta_i(self) -> NDArray[np.float64]: ...
    @property
    def phi_i(self) -> NDArray[np.float64]: ...
    @property
    def resolution(self) -> tuple[int, int]: ...
    @property
    def negative_share(self) -> dict[str, float]: ...

def is_tensor_file(path: str | PathLike[str]) -> bool: ...
def read_rgl(path: str | PathLike[str]) -> Rgl: ...
def is_merl(path: str | PathLike[str]) -> bool: ...
def is_sir(path: str | PathLike[str]) -> bool: ...
def read_sir(path: str | PathLike[str]) -> tuple[Bsdf, dict[str, Any]]: ...
def read_merl(path: str | PathLike[str]) -> tuple[Bsdf, float]: ...
def write_merl(path: str | PathLike[str], bsdf: Bsdf, channels: tuple[str, str, str]) -> Bsdf: ...
def write_rgl(
    path: str | PathLike[str],
    bsdf: Bsdf,
    channels: Sequence[tuple[str, str]],
    *,
    description: str = "",
    theta_i: Sequence[float] | None = None,
    resolution: int | None = None,
) -> Bsdf: ...
def write_zemax(
    path: str | PathLike[str],
    bsdf: Bsdf,
    *,
    channel: str | None = None,
    component: str = "reflection",
    rotations: Sequence[float] | None = None,
    incidences: Sequence[float] | None = None,
    azimuths: Sequence[float] | None = None,
    radials: Sequence[float] | None = None,
    comments: str = "",
) -> tuple[str, int]: ...
def tabulate(
    model: Bsdf,
    *,
    incidences: Sequence[tuple[float, float]] | None = None,
    components: Sequence[str] | None = None,
    channels: Sequence[str] | None = None,
    pitch: float | None = None,
    peak_pitch: float | None = None,
    growth: float | None = None,
    reach: float | None = None,
    theta_max: float | None = None,
    u_relative: float | None = None,
    u_floor: float | None = None,
    sample_name: str | None = None,
) -> MeasurementData: ...

@final
class Scene:
    @property
    def primitives(self) -> int: ...
    @property
    def view(self) -> str | None: ...

@final
class Samples:
    def __init__(self, places: int) -> None: ...
    @staticmethod
    def from_arrays(
        *, sum: ArrayLike, square: ArrayLike, count: ArrayLike, goal: int, floor: float
    ) -> Samples: ...
    def to_arrays(self) -> dict[str, Any]: ...
    def mean(self) -> NDArray[np.float64]: ...
    def luminance(self) -> NDArray[np.float64]: ...
    def error(self) -> NDArray[np.float64]: ...

@final
class RenderWatch:
    def __init__(self) -> None: ...
    def progress(self) -> tuple[float, float]: ...
    def stop(self) -> None: ...

def studio_scene(model: Bsdf) -> tuple[Scene, str]: ...
def read_scene(
    paths: Sequence[PathLike[str]],
    search: Sequence[PathLike[str]],
    *,
    model: Callable[[str | PathLike[str]], Bsdf],
) -> tuple[Scene, list[str]]: ...

@final
class Device:
    @property
    def window(self) -> tuple[float, float, float, float]: ...
    def patches(
        self,
        *,
        basis: str,
        rays: int,
        front: bool,
        back: bool,
        bounces: int,
        seed: int,
        watch: RenderWatch,
    ) -> tuple[Klems, Klems, dict[tuple[str, str], tuple[NDArray[np.float64], NDArray[np.float64]]]]: ...
    def trees(
        self,
        *,
        rank: int,
        levels: int,
        rays: int,
        front: bool,
        back: bool,
        bounces: int,
        seed: int,
        tolerance: float,
        max_cells: int,
        watch: RenderWatch,
    ) -> tuple[TensorTree, TensorTree, dict[tuple[str, str], tuple[float, float, float]]]: ...

def read_device(
    paths: Sequence[PathLike[str]],
    search: Sequence[PathLike[str]],
    *,
    model: Callable[[str | PathLike[str]], Bsdf],
    window: Sequence[float] | None,
    periodic: bool,
) -> tuple[Device, list[str]]: ...
def simulate_device(
    device: Device,
    *,
    unit: float,
    share: float,
    joined: int,
    met: int,
    incidences: Sequence[tuple[float, float]],
    components: Sequence[str],
    seed: int,
    sample_name: str | None = None,
    started: str | None = None,
    settings: Mapping[str, float],
    parts: Mapping[str, Any] | None = None,
    beam_scans: int = 3,
    watch: Callable[[int, int], None] | None = None,
) -> tuple[list[Scan], list[tuple[int, int, list[float]]]]: ...
def rounded_rays(rays: int) -> int: ...

@final
class IntegratingSphere:
    def __init__(
        self,
        *,
        arrangement: str,
        settings: Mapping[str, float],
        baffles: Sequence[tuple[str, str, float, float, float]],
    ) -> None: ...
    @property
    def ports(self) -> list[tuple[str, list[float], float, float]]: ...
    @property
    def screens(self) -> list[tuple[list[float], list[float], float]]: ...
    @property
    def cone(self) -> tuple[float, float] | None: ...
    def integrals(self, model: Bsdf, *, channel: str | None = None) -> tuple[float, float | None]: ...
    def multiplier(self, *, first: float, filled: Mapping[str, float]) -> float: ...
    def measure(
        self,
        model: Bsdf,
        *,
        channel: str | None,
        method: str,
        rays: int,
        seed: int,
        watch: RenderWatch,
    ) -> dict[str, Any]: ...

def cone_integral(
    model: Bsdf,
    *,
    theta_i: float,
    phi_i: float,
    component: str,
    half_angle: float,
    channel: str | None = None,
) -> float: ...
def klems_solid_angles(basis: str) -> NDArray[np.float64]: ...
def read_view(path: str | PathLike[str]) -> str: ...
def view_options(text: str, width: int, height: int) -> tuple[str, int, int]: ...
def render_picture(
    scene: Scene,
    into: Samples,
    *,
    view: str,
    width: int,
    samples: int,
    relative_error: float | None,
    bounces: int,
    seed: int,
    watch: RenderWatch,
    threads: int | None = None,
) -> None: ...
def render_sensors(
    scene: Scene,
    into: Samples,
    *,
    sensors: ArrayLike,
    samples: int,
    relative_error: float | None,
    bounces: int,
    seed: int,
    watch: RenderWatch,
    threads: int | None = None,
) -> None: ...
def write_picture(
    path: str | PathLike[str], *, samples: Samples, width: int, view: str, software: str
) -> None: ...
