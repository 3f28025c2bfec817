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
    first: int = 0
    """The first stage of tests (driver.STAGES) that can see it."""


SLOPES = "analytic/slopes.rs"
MODEL = "analytic/model.rs"
TRANSMISSION = "analytic/transmission_lobe.rs"
ASHIKHMIN = "analytic/ashikhmin_shirley.rs"
GGX = "analytic/microfacet/ggx.rs"
BECKMANN = "analytic/microfacet/beckmann.rs"
FRESNEL = "analytic/microfacet/fresnel.rs"
REFLECTION = "analytic/microfacet/reflection.rs"
INTERFACE = "analytic/microfacet/interface.rs"
COMPENSATION = "analytic/microfacet/compensation.rs"

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
        first=1,
    ),
    Mutant(
        "the larger of two cosines replaced by the one of the incidence",
        ASHIKHMIN,
        "cosine * ci.max(cs) * 4.0",
        "cosine * ci * 4.0",
        ("ashikhmin-shirley",),
        first=1,
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
    Mutant(
        "the transmission lobe 2 alpha wide, as a reflection lobe is, in value, density and samples alike",
        TRANSMISSION,
        """    let inverse_square = p[1].squared().recip();
    Shape {
        alpha: p[1],""",
        """    let inverse_square = (p[1] * 2.0).squared().recip();
    Shape {
        alpha: p[1] * 2.0,""",
        ("transmission-lobe", "bounded-transmission-lobe"),
        first=2,
    ),
    Mutant(
        "the masking of GGX facets dropped",
        GGX,
        "sum.recip() * 0.5",
        "(sum * 0.0 + 1.0).times(ci * cs * R::Plain::constant(4.0)).recip()",
        ("ggx",),
        first=1,
    ),
    Mutant(
        "the masking of Beckmann facets dropped",
        BECKMANN,
        "((lambdas + 1.0).times(wi[2]",
        "((lambdas * 0.0 + 1.0).times(wi[2]",
        ("beckmann",),
        first=1,
    ),
    Mutant(
        "the masking of refracted light dropped",
        INTERFACE,
        """* D::masking::<W, R>(widths, pair.wi)
        * D::masking::<W, R>(widths, pair.ws);""",
        "* R::lift((pair.wi[2] * pair.ws[2]).abs().recip());",
        ("ggx-dielectric",),
    ),
    Mutant(
        "Fresnel's reflectance at the angle to the surface's normal",
        REFLECTION,
        "F::reflectance::<R>(&shape.fresnel, cosine)",
        "F::reflectance::<R>(&shape.fresnel, pair.wi[2])",
        ("ggx", "ggx-conductor"),
        first=1,
    ),
    Mutant(
        "Fresnel's reflectance at the mean of both angles to the surface's normal, which is reciprocal",
        REFLECTION,
        "F::reflectance::<R>(&shape.fresnel, cosine)",
        "F::reflectance::<R>(&shape.fresnel, (pair.wi[2] + pair.ws[2]) * R::Plain::constant(0.5))",
        ("ggx", "ggx-conductor"),
        first=2,
    ),
    Mutant(
        "the sign of the rise of Schlick's reflectance wrong",
        FRESNEL,
        "f0.times(R::Plain::constant(1.0) - rise).plus(rise)",
        "f0.times(R::Plain::constant(1.0) - rise).plus(-rise)",
        ("ggx", "beckmann"),
        first=2,
    ),
    Mutant(
        "the square of a complex index with the wrong sign",
        FRESNEL,
        "real: eta2 - k2,",
        "real: eta2 + k2,",
        ("ggx-conductor",),
        first=3,
    ),
    Mutant(
        "the squared index missing from the Jacobian of refraction",
        INTERFACE,
        "* (inverse2 * eta).squared()",
        "* inverse2.squared()",
        ("ggx-dielectric",),
    ),
    Mutant(
        "the two cosines to the facet missing from refraction",
        INTERFACE,
        """    let f = facing_i
        * facing_s
        *""",
        """    let f = length2
        *""",
        ("beckmann-dielectric",),
    ),
    Mutant(
        "light from behind refracted by the index of light from the front",
        INTERFACE,
        "eta: shape.eta.recip(),",
        "eta: shape.eta,",
        ("ggx-dielectric",),
        first=1,
    ),
    Mutant(
        "the theta of the given and of the sampled direction swapped in the density of visible normals",
        REFLECTION,
        "mirrored_density::<D, W>(&shape.widths, w, s)",
        "mirrored_density::<D, W>(&shape.widths, s, w)",
        ("ggx", "beckmann"),
    ),
    Mutant(
        "visible normals of a surface that is not stretched",
        GGX,
        "let v = W::stretch(widths, w);",
        "let v = w;",
        ("ggx-anisotropic",),
    ),
    Mutant(
        "the broad lobe of compensated facets missing from their density",
        COMPENSATION,
        "(1.0 - share) * self.single.pdf(w, sampled) + share * cosine_density(upward)",
        "share.mul_add(0.0, self.single.pdf(w, sampled)) + 0.0 * cosine_density(upward)",
        ("ggx-conductor-compensated",),
    ),
    Mutant(
        "compensation by the loss at one of the two directions",
        COMPENSATION,
        "m.factor * lost(wi) * lost(ws) / (PI * all)",
        "m.factor * lost(wi) * all / (PI * all)",
        ("beckmann-compensated",),
        first=1,
    ),
    Mutant(
        "one reflection too few in the light given back",
        COMPENSATION,
        "let factor = fresnel * fresnel * table.mean()",
        "let factor = fresnel * table.mean()",
        ("ggx-compensated", "ggx-conductor-compensated"),
        first=2,
    ),
)
