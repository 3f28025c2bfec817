"""The words and conventions of the page."""

TERMS: tuple[tuple[str, str, str], ...] = (
    (
        "dsf",
        "DSF [1/sr]",
        "Differential scattering function: scattered intensity for each unit of incident power. It is "
        "the BSDF times |cos θs|, so it goes to zero at the horizon for a matt surface. It is what "
        "the detector sees, and what gonio keeps as the primary quantity.",
    ),
    (
        "bsdf",
        "BSDF [1/sr]",
        "Bidirectional scattering distribution function: scattered radiance over incident irradiance, "
        "without a cosine. Near the horizon it divides a small signal by a small cosine, and its "
        "noise grows accordingly.",
    ),
    (
        "dhr",
        "DHR, DHT",
        "Directional-hemispherical reflectance and transmittance: the integral of the DSF over the "
        "hemisphere on the side of incidence, or over the other one. Without absorption the two add "
        "up to 1.",
    ),
    (
        "extrapolated",
        "Extrapolated share",
        "The part of DHR or DHT that comes from directions without a reading: the grazing gap and the "
        "shadow of the detector. It is included in the value and its uncertainty, and shown apart.",
    ),
    (
        "frame",
        "Frame and angles",
        "z is the outward normal of the sample's front, x its zero-azimuth mark. θ runs from z (0° to "
        "180°; above 90° is the back), φ counter-clockwise from x seen from the front. Every "
        "direction leaves the sample: the incidence (θi, φi) points towards the source, (θs, φs) "
        "towards the detector.",
    ),
    (
        "extended",
        "Extended polar angle",
        "Polar angle along the plane of incidence, from −90° to 270°: −90° to 90° over the front, 90° "
        "to 270° over the back. The incidence lies at −θi, the mirror direction at +θi, unbent "
        "transmission at 180° − θi.",
    ),
    (
        "k2",
        "± … (k = 2)",
        "Expanded uncertainty: twice the combined standard uncertainty, which holds the true value in "
        "about 95 % of cases. The band around a profile is drawn with the same k.",
    ),
    (
        "floor",
        "Noise floor",
        "The DSF that equals two standard uncertainties u of the weakest readings. Below it a reading "
        "says only that the material scatters less than that, and the maps are striped grey. The check "
        "of the signal compares with a single u.",
    ),
    (
        "negative",
        "Negative readings",
        "A reading below zero after the dark was subtracted is noise, not an error. It is kept, "
        "because removing it would bias every average upwards. On a logarithmic scale it is marked at "
        "the lower edge.",
    ),
    (
        "signature",
        "Resolution",
        "Full width at half maximum of the instrument's own beam, measured without a sample. No "
        "structure narrower than this can be seen; a peak of this width may be narrower in truth.",
    ),
    (
        "gaps",
        "Not measured",
        "Surfaces and profiles join neighbouring readings only. Where neighbours lie more than about "
        "twice the usual distance apart, nothing is drawn: the maps show the grey ground and the "
        "profiles a gap.",
    ),
)
"""Anchor, term and meaning."""
