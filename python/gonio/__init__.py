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
from gonio.device_readings import GeometryCampaign, simulate_readings
from gonio.devices import GeometryBsdf, PatchMeans, simulate_geometry
from gonio.exporting import Export, export, read_radiance
from gonio.fit_parameters import Estimate, FitModel, FitParameter
from gonio.fit_results import Fit, FitWarning, HeldOut, Ranking, SliceResidual, SphereResidual
from gonio.fit_spheres import SphereReading, SphereReadings, fit_sphere, read_sphere_readings
from gonio.fitting import fit, fit_models
from gonio.inspecting import inspect
from gonio.instruments import Instrument, read_instrument
from gonio.measurement import Measurement
from gonio.model_files import read_bsdf
from gonio.picture_files import Picture, false_colour, tone_mapped
from gonio.planning import Plan, PlannedLobe, PlannedScan, plan
from gonio.previewing import preview, studio_scene
from gonio.processing import process
from gonio.radiance_materials import read_materials, write_materials
from gonio.readings import Readings, read
from gonio.reducing import Reduction, reduce
from gonio.rendering import read_scene, render
from gonio.rendering_runs import RenderProgress
from gonio.reporting import report
from gonio.sensing import SensorReadings, read_sensors, render_sensors
from gonio.simulating import simulate
from gonio.sphere_drawing import draw_sphere
from gonio.sphere_integrals import ConeValue, SphereIntegrals, cone_integral, sphere_integrals
from gonio.sphere_readings import SphereResult, specularity
from gonio.sphere_simulation import SphereFlux, SphereMeasurement, SphereValue, sphere
from gonio.spheres import Sphere, read_sphere
from gonio.surface_geometry import SurfaceGeometry, surface
from gonio.surface_roughness import Roughness, roughness
from gonio.tabulating import tabulate

__all__ = [
    "FLAGS",
    "Bsdf",
    "Colour",
    "Compact",
    "ComparedIncidence",
    "ConeValue",
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
    "GeometryBsdf",
    "GeometryCampaign",
    "GonioError",
    "HeldOut",
    "HemisphericalIntegral",
    "Instrument",
    "Measurement",
    "Model",
    "ModelComparison",
    "ModelParameter",
    "PatchMeans",
    "Picture",
    "Plan",
    "PlannedLobe",
    "PlannedScan",
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
    "Sphere",
    "SphereFlux",
    "SphereIntegrals",
    "SphereMeasurement",
    "SphereReading",
    "SphereReadings",
    "SphereResidual",
    "SphereResult",
    "SphereValue",
    "SurfaceGeometry",
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
    "cone_integral",
    "demo",
    "directional_albedo",
    "draw_sphere",
    "export",
    "false_colour",
    "fit",
    "fit_models",
    "fit_sphere",
    "inspect",
    "models",
    "plan",
    "preview",
    "process",
    "read",
    "read_bsdf",
    "read_instrument",
    "read_materials",
    "read_radiance",
    "read_scene",
    "read_sensors",
    "read_sphere",
    "read_sphere_readings",
    "reduce",
    "render",
    "render_sensors",
    "report",
    "roughness",
    "simulate",
    "simulate_geometry",
    "simulate_readings",
    "specularity",
    "sphere",
    "sphere_integrals",
    "studio_scene",
    "surface",
    "tabulate",
    "tone_mapped",
    "write_compact",
    "write_materials",
]
