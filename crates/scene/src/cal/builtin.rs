//! Functions that the language itself knows.

use super::noise;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Builtin {
    If,
    Select,
    Min,
    Max,
    Arg,
    Sqrt,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Floor,
    Ceil,
    Exp,
    Log,
    Log10,
    Erf,
    Erfc,
    Rand,
    Noise3,
    Noise3X,
    Noise3Y,
    Noise3Z,
    Fnoise3,
    Hermite,
}

/// Name, function, arguments needed.
const TABLE: [(&str, Builtin, usize); 27] = [
    ("if", Builtin::If, 3),
    ("select", Builtin::Select, 1),
    ("min", Builtin::Min, 1),
    ("max", Builtin::Max, 1),
    ("arg", Builtin::Arg, 1),
    ("sqrt", Builtin::Sqrt, 1),
    ("sin", Builtin::Sin, 1),
    ("cos", Builtin::Cos, 1),
    ("tan", Builtin::Tan, 1),
    ("asin", Builtin::Asin, 1),
    ("acos", Builtin::Acos, 1),
    ("atan", Builtin::Atan, 1),
    ("atan2", Builtin::Atan2, 2),
    ("floor", Builtin::Floor, 1),
    ("ceil", Builtin::Ceil, 1),
    ("exp", Builtin::Exp, 1),
    ("log", Builtin::Log, 1),
    ("log10", Builtin::Log10, 1),
    ("erf", Builtin::Erf, 1),
    ("erfc", Builtin::Erfc, 1),
    ("rand", Builtin::Rand, 1),
    ("noise3", Builtin::Noise3, 3),
    ("noise3x", Builtin::Noise3X, 3),
    ("noise3y", Builtin::Noise3Y, 3),
    ("noise3z", Builtin::Noise3Z, 3),
    ("fnoise3", Builtin::Fnoise3, 3),
    ("hermite", Builtin::Hermite, 5),
];

impl Builtin {
    pub(super) fn named(name: &str) -> Option<Self> {
        TABLE.iter().find(|entry| entry.0 == name).map(|entry| entry.1)
    }

    pub(super) fn name(self) -> &'static str {
        TABLE
            .iter()
            .find(|entry| entry.1 == self)
            .map_or("", |entry| entry.0)
    }

    pub(super) fn needed(self) -> usize {
        TABLE
            .iter()
            .find(|entry| entry.1 == self)
            .map_or(0, |entry| entry.2)
    }

    /// The value of the functions that need no more than the values of their first arguments; not finite outside the
    /// domain. Those that choose among their arguments (`if`, `select`, `min`, `max`, `arg`) are the evaluator's.
    pub(super) fn value(self, a: [f64; 5]) -> f64 {
        let x = a[0];
        let point = [a[0], a[1], a[2]];
        match self {
            Builtin::If | Builtin::Select | Builtin::Min | Builtin::Max | Builtin::Arg => f64::NAN,
            Builtin::Sqrt => x.sqrt(),
            Builtin::Sin => x.sin(),
            Builtin::Cos => x.cos(),
            Builtin::Tan => x.tan(),
            Builtin::Asin => x.asin(),
            Builtin::Acos => x.acos(),
            Builtin::Atan => x.atan(),
            Builtin::Atan2 => x.atan2(a[1]),
            Builtin::Floor => x.floor(),
            Builtin::Ceil => x.ceil(),
            Builtin::Exp => x.exp(),
            Builtin::Log => x.ln(),
            Builtin::Log10 => x.log10(),
            Builtin::Erf => libm::erf(x),
            Builtin::Erfc => libm::erfc(x),
            Builtin::Rand => rand(x),
            Builtin::Noise3 => noise::perlin(point),
            Builtin::Noise3X => noise::noise3(point)[0],
            Builtin::Noise3Y => noise::noise3(point)[1],
            Builtin::Noise3Z => noise::noise3(point)[2],
            Builtin::Fnoise3 => noise::fnoise3(point),
            Builtin::Hermite => noise::hermite(a[0], a[1], a[2], a[3], a[4]),
        }
    }
}

/// A number in [0, 1) from any number, RADIANCE's own mixing [Radiance, its program].
#[expect(
    clippy::approx_constant,
    reason = "the program's own digits: the mixing turns their end into the result"
)]
fn rand(x: f64) -> f64 {
    let x = x * (1.0 / (1.0 + x * x) + 2.718_281_828_459_04);
    let x = 1e5 / (x + (0.785_398_163_397_447 - x.floor()));
    x - x.floor()
}
