"""gonio: from the raw readings of a goniophotometer to a checked scattering model."""

from gonio._native import (
    FLAGS,
    Bsdf,
    Compact,
    DataDriven,
    DomainError,
    FitError,
    FormatError,
    GonioError,
    HemisphericalIntegral,
    QuantityError,
    RadianceMaterial,
    Resolution,
    Rgl,
    Scan,
    Scene,
    Slice,
    Verdict,
    __version__,
)
from gonio.analytic import Model, ModelParameter, analytic, directional_albedo, models
from gonio.building import build
from gonio.checking import check
from gonio.checking_models import check_model
from gonio.colours import Colour, colour, colour_of_channels
from gonio.compact_files import write_compact
from gonio.comparing import ComparedIncidence, ModelComparison, compare
from gonio.comparing_pictures import compare_picture
from gonio.demonstrating import DemoResult, demo
from gonio.exporting import Export, export, read_radiance
from gonio.fit_parameters import Estimate, FitModel, FitParameter
from gonio.fit_results import Fit, FitWarning, HeldOut, Ranking, SliceResidual
from gonio.fitting import fit, fit_models
from gonio.inspecting import inspect
from gonio.measurement import Measurement
from gonio.model_files import read_bsdf
from gonio.picture_files import Picture, false_colour, tone_mapped
from gonio.previewing import preview, studio_scene
from gonio.processing import process
from gonio.radiance_materials import read_materials, write_materials
from gonio.readings import Readings, read
from gonio.reducing import Reduction, reduce
from gonio.rendering import (
    RenderProgress,
    SensorReadings,
    read_scene,
    read_sensors,
    render,
    render_sensors,
)
from gonio.reporting import report
from gonio.simulating import simulate
from gonio.sphere_readings import SphereResult, specularity
from gonio.surface_roughness import Roughness, roughness
from gonio.tabulating import tabulate

__all__ = [
    "FLAGS",
    "Bsdf",
    "Colour",
    "Compact",
    "ComparedIncidence",
    "DataDriven",
    "DemoResult",
    "DomainError",
    "Estimate",
    "Export",
    "Fit",
    "FitError",
    "FitModel",
    "FitParameter",
    "FitWarning",
    "FormatError",
    "GonioError",
    "HeldOut",
    "HemisphericalIntegral",
    "Measurement",
    "Model",
    "ModelComparison",
    "ModelParameter",
    "Picture",
    "QuantityError",
    "RadianceMaterial",
    "Ranking",
    "Readings",
    "Reduction",
    "RenderProgress",
    "Resolution",
    "Rgl",
    "Roughness",
    "Scan",
    "Scene",
    "SensorReadings",
    "Slice",
    "SliceResidual",
    "SphereResult",
    "Verdict",
    "__version__",
    "analytic",
    "build",
    "check",
    "check_model",
    "colour",
    "colour_of_channels",
    "compare",
    "compare_picture",
    "demo",
    "directional_albedo",
    "export",
    "false_colour",
    "fit",
    "fit_models",
    "inspect",
    "models",
    "preview",
    "process",
    "read",
    "read_bsdf",
    "read_materials",
    "read_radiance",
    "read_scene",
    "read_sensors",
    "reduce",
    "render",
    "render_sensors",
    "report",
    "roughness",
    "simulate",
    "specularity",
    "studio_scene",
    "tabulate",
    "tone_mapped",
    "write_compact",
    "write_materials",
]
