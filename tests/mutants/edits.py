"""The mistakes."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Mutant:
    """One mistake: `old`, which stands once in `file` (below crates/bsdf/src), becomes `new`."""

    mistake: str
    file: str
    old: str
    new: str
    models: tuple[str, ...]
    samples: int = 200_000


SLOPES = "analytic/slopes.rs"
MODEL = "analytic/model.rs"
TRANSMISSION = "analytic/transmission_lobe.rs"
ASHIKHMIN = "analytic/ashikhmin_shirley.rs"

MUTANTS = (
    Mutant(
        "the density of cosine-weighted directions without its cosine",
        "analytic/lambert.rs",
        "s.cos_theta().max(0.0) / PI",
        "f64::from(s.cos_theta() > 0.0) * 0.5 / PI",
        ("lambert", "oren-nayar"),
    ),
    Mutant(
        "the weight of a sample without the cosine",
        MODEL,
        "self.eval_first(w, direction) * direction.cos_theta().abs() / pdf",
        "self.eval_first(w, direction) / pdf",
        ("lambert", "ward-gmd"),
    ),
    Mutant(
        "the given and the sampled direction swapped in the density",
        MODEL,
        "in_front(w, w), in_front(w, sampled))",
        "in_front(w, sampled), in_front(w, w))",
        ("lambert", "ashikhmin-shirley"),
    ),
    Mutant(
        "the Jacobian of the half vector forgotten: the density of facets taken for that of directions",
        SLOPES,
        "self.density(h) * length2 / (h[2] * h[2] * h[2] * 2.0)",
        "self.density(h) * length2 * length2.sqrt() / (h[2] * h[2] * h[2])",
        ("ward-gmd",),
    ),
    Mutant(
        "the density of slopes normalised to one half",
        SLOPES,
        "(alpha.squared() * PI).recip()",
        "(alpha.squared() * (2.0 * PI)).recip()",
        ("ward-gmd",),
    ),
    Mutant(
        "the axes of an anisotropic sampler turned the wrong way",
        SLOPES,
        "[c * x - s * y, s * x + c * y, R::constant(1.0)]",
        "[c * x + s * y, c * y - s * x, R::constant(1.0)]",
        ("ward-gmd-anisotropic",),
    ),
    Mutant(
        "the exponent of the sampled lobe off by 2 %",
        SLOPES,
        "(-(R::constant(1.0) - u[0]).ln())",
        "((R::constant(1.0) - u[0]).ln() * -0.98)",
        ("ward-gmd",),
        2_000_000,
    ),
    Mutant(
        "the normaliser of the Ward lobe with a power of the cosine missing",
        "analytic/ward_gmd.rs",
        "* inverse * inverse",
        "* inverse",
        ("ward-gmd",),
    ),
    Mutant(
        "a transmission lobe sampled by the factor of the root of two too wide",
        TRANSMISSION,
        "-0.5 * shape.alpha * shape.alpha",
        "-shape.alpha * shape.alpha",
        ("transmission-lobe", "bounded-transmission-lobe"),
    ),
    Mutant(
        "the cosine of one direction instead of the mean of both",
        TRANSMISSION,
        "|ci, cs| (ci + cs).recip() * 2.0",
        "|ci, _| ci.recip()",
        ("bounded-transmission-lobe",),
    ),
    Mutant(
        "the sign of the rise of the Fresnel reflectance wrong",
        ASHIKHMIN,
        "(-shape.f0 + 1.0).times(fifth(-cosine + 1.0))",
        "(shape.f0 - 1.0).times(fifth(-cosine + 1.0))",
        ("ashikhmin-shirley",),
    ),
    Mutant(
        "the larger of two cosines replaced by the one of the incidence",
        ASHIKHMIN,
        "cosine * ci.max(cs) * 4.0",
        "cosine * ci * 4.0",
        ("ashikhmin-shirley",),
    ),
    Mutant(
        "the density over the projected disk taken for that over solid angle",
        "analytic/shift_invariant.rs",
        " * s.cos_theta().abs()\n}",
        "\n}",
        ("abg", "harvey-shack-transmission"),
    ),
    Mutant(
        "a sample of a sum weighed with the density of its part alone",
        "analytic/sum.rs",
        "let pdf = Bsdf::pdf(self, w, drawn.direction);",
        "let pdf = drawn.pdf;",
        ("sum",),
    ),
)
