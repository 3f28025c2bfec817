//! The materials of RADIANCE as its users write them: one type a file, the parameters exactly as in a `.rad` file
//! [Radiance, rt/normal.c, aniso.c, ashikhmin.c, glass.c, m_mirror.c, dielectric.c].
//!
//! Each type lists its real arguments as data ([`Parameters::ARGUMENTS`]); `gonio_io::radiance_material` reads and
//! writes the text.

mod argument;
mod ashik2;
mod dielectric;
mod glass;
mod metal;
mod metal2;
mod mirror;
mod model;
mod orientation;
mod plastic;
mod plastic2;
#[cfg(test)]
mod tests;
mod trans;
mod trans2;

pub use argument::Argument;
pub use ashik2::Ashik2;
pub use dielectric::Dielectric;
pub use glass::Glass;
pub use metal::Metal;
pub use metal2::Metal2;
pub use mirror::Mirror;
pub use model::Release;
pub use orientation::Orientation;
pub use plastic::Plastic;
pub use plastic2::Plastic2;
pub use trans::Trans;
pub use trans2::Trans2;

use crate::BsdfError;

/// Red, green and blue of RADIANCE.
pub type Rgb = [f64; 3];

/// What every material type has in common: a name and an ordered list of arguments.
pub trait Parameters: Sized {
    /// The word of the type in a `.rad` file.
    const TYPE: &'static str;
    /// The real arguments in order.
    const ARGUMENTS: &'static [Argument];

    /// The material of these arguments, in order.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the argument that is missing, too much or outside its range.
    fn from_arguments(strings: &[String], reals: &[f64]) -> Result<Self, BsdfError>;

    /// The real arguments in order.
    fn reals(&self) -> Vec<f64>;

    /// The string arguments in order.
    fn strings(&self) -> Vec<String> {
        Vec::new()
    }

    /// That every parameter lies in its range: the fields are public, so writers and models ask again.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the argument.
    fn check(&self) -> Result<(), BsdfError> {
        check_reals::<Self>(&self.reals())
    }

    /// `self` when [`Parameters::check`] passes.
    ///
    /// # Errors
    /// Those of [`Parameters::check`].
    fn checked(self) -> Result<Self, BsdfError> {
        self.check()?;
        Ok(self)
    }
}

fn check_reals<P: Parameters>(reals: &[f64]) -> Result<(), BsdfError> {
    if !argument::counts(P::ARGUMENTS).contains(&reals.len()) {
        return Err(argument::wrong_count(P::ARGUMENTS, reals.len()));
    }
    P::ARGUMENTS.iter().zip(reals).try_for_each(|(a, &v)| a.check(v))
}

/// The first three reals as a colour; the list has been checked to hold them.
fn rgb(reals: &[f64]) -> Rgb {
    [reals[0], reals[1], reals[2]]
}

/// A material of any of the ten types.
#[derive(Clone, Debug, PartialEq)]
pub enum RadianceMaterial {
    /// Diffuse colour under an uncoloured gloss.
    Plastic(Plastic),
    /// Gloss in the colour of the metal.
    Metal(Metal),
    /// Translucent: plastic that also transmits.
    Trans(Trans),
    /// Plastic of two roughnesses.
    Plastic2(Plastic2),
    /// Metal of two roughnesses.
    Metal2(Metal2),
    /// Trans of two roughnesses.
    Trans2(Trans2),
    /// The Ashikhmin-Shirley model.
    Ashik2(Ashik2),
    /// A thin pane as one surface.
    Glass(Glass),
    /// An ideal mirror.
    Mirror(Mirror),
    /// The boundary of a solid transparent body.
    Dielectric(Dielectric),
}

/// Runs an expression on the parameters inside, whatever the type.
macro_rules! each {
    ($self:expr, $m:ident => $body:expr) => {
        match $self {
            RadianceMaterial::Plastic($m) => $body,
            RadianceMaterial::Metal($m) => $body,
            RadianceMaterial::Trans($m) => $body,
            RadianceMaterial::Plastic2($m) => $body,
            RadianceMaterial::Metal2($m) => $body,
            RadianceMaterial::Trans2($m) => $body,
            RadianceMaterial::Ashik2($m) => $body,
            RadianceMaterial::Glass($m) => $body,
            RadianceMaterial::Mirror($m) => $body,
            RadianceMaterial::Dielectric($m) => $body,
        }
    };
}

fn arguments_like<P: Parameters>(_: &P) -> &'static [Argument] {
    P::ARGUMENTS
}

fn type_of<P: Parameters>(_: &P) -> &'static str {
    P::TYPE
}

impl RadianceMaterial {
    /// The words of the ten types.
    pub const TYPES: [&'static str; 10] = [
        Plastic::TYPE,
        Metal::TYPE,
        Trans::TYPE,
        Plastic2::TYPE,
        Metal2::TYPE,
        Trans2::TYPE,
        Ashik2::TYPE,
        Glass::TYPE,
        Mirror::TYPE,
        Dielectric::TYPE,
    ];

    /// The material of type `word` with these arguments; `None` when the type is not one of [`Self::TYPES`].
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the argument that is missing, too much or outside its range.
    pub fn from_arguments(word: &str, strings: &[String], reals: &[f64]) -> Option<Result<Self, BsdfError>> {
        fn of<P: Parameters + Into<RadianceMaterial>>(
            strings: &[String],
            reals: &[f64],
        ) -> Option<Result<RadianceMaterial, BsdfError>> {
            Some(check_reals::<P>(reals).and_then(|()| P::from_arguments(strings, reals).map(Into::into)))
        }
        match word {
            Plastic::TYPE => of::<Plastic>(strings, reals),
            Metal::TYPE => of::<Metal>(strings, reals),
            Trans::TYPE => of::<Trans>(strings, reals),
            Plastic2::TYPE => of::<Plastic2>(strings, reals),
            Metal2::TYPE => of::<Metal2>(strings, reals),
            Trans2::TYPE => of::<Trans2>(strings, reals),
            Ashik2::TYPE => of::<Ashik2>(strings, reals),
            Glass::TYPE => of::<Glass>(strings, reals),
            Mirror::TYPE => of::<Mirror>(strings, reals),
            Dielectric::TYPE => of::<Dielectric>(strings, reals),
            _ => None,
        }
    }

    /// Names, ranges and meaning of the real arguments of type `word`, in order; `None` when the type is not one of
    /// [`Self::TYPES`].
    pub fn arguments_of(word: &str) -> Option<&'static [Argument]> {
        match word {
            Plastic::TYPE => Some(Plastic::ARGUMENTS),
            Metal::TYPE => Some(Metal::ARGUMENTS),
            Trans::TYPE => Some(Trans::ARGUMENTS),
            Plastic2::TYPE => Some(Plastic2::ARGUMENTS),
            Metal2::TYPE => Some(Metal2::ARGUMENTS),
            Trans2::TYPE => Some(Trans2::ARGUMENTS),
            Ashik2::TYPE => Some(Ashik2::ARGUMENTS),
            Glass::TYPE => Some(Glass::ARGUMENTS),
            Mirror::TYPE => Some(Mirror::ARGUMENTS),
            Dielectric::TYPE => Some(Dielectric::ARGUMENTS),
            _ => None,
        }
    }

    /// The word of the type in a `.rad` file.
    pub fn type_word(&self) -> &'static str {
        each!(self, m => type_of(m))
    }

    /// Names, ranges and meaning of the real arguments, in order.
    pub fn arguments(&self) -> &'static [Argument] {
        each!(self, m => arguments_like(m))
    }

    /// The real arguments in order; as many as the material was given.
    pub fn reals(&self) -> Vec<f64> {
        each!(self, m => m.reals())
    }

    /// The string arguments in order.
    pub fn strings(&self) -> Vec<String> {
        each!(self, m => m.strings())
    }

    /// That every parameter lies in its range.
    ///
    /// # Errors
    /// [`BsdfError::Domain`] naming the argument.
    pub fn check(&self) -> Result<(), BsdfError> {
        each!(self, m => m.check())
    }
}

macro_rules! into_material {
    ($($name:ident),*) => {
        $(impl From<$name> for RadianceMaterial {
            fn from(m: $name) -> Self {
                RadianceMaterial::$name(m)
            }
        })*
    };
}
into_material!(
    Plastic, Metal, Trans, Plastic2, Metal2, Trans2, Ashik2, Glass, Mirror, Dielectric
);
