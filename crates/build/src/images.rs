//! Symmetry about the normal: what an isotropic sample lacks, and what of it an anisotropic one keeps.

use gonio_geom::DVec3;

/// A mirror image at a plane through the normal, half a turn, or neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Image {
    /// `x` changes its sign.
    flips_x: bool,
    /// `y` changes its sign.
    flips_y: bool,
}

impl Image {
    /// Nothing changes.
    pub(crate) const SAME: Image = Image {
        flips_x: false,
        flips_y: false,
    };
    /// Mirrored at the plane `x = 0`.
    pub(crate) const FLIP_X: Image = Image {
        flips_x: true,
        flips_y: false,
    };
    /// Mirrored at the plane `y = 0`.
    pub(crate) const FLIP_Y: Image = Image {
        flips_x: false,
        flips_y: true,
    };
    /// Turned by pi about the normal.
    pub(crate) const HALF_TURN: Image = Image {
        flips_x: true,
        flips_y: true,
    };

    /// The image of `v`; each image is its own inverse.
    #[inline]
    pub(crate) fn of(self, v: DVec3) -> DVec3 {
        let [x, y] = self.of_point([v.x, v.y]);
        DVec3::new(x, y, v.z)
    }

    /// The image of the two components in the sample plane.
    #[inline]
    pub(crate) fn of_point(self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            if self.flips_x { -x } else { x },
            if self.flips_y { -y } else { y },
        ]
    }

    /// The cell of azimuth, of `count` (even) from 0, that cell `k` goes to.
    pub(crate) fn of_cell(self, k: usize, count: usize) -> usize {
        let turned = if self.flips_x { k + count / 2 } else { k };
        let mirrored = if self.flips_x == self.flips_y {
            turned
        } else {
            2 * count - turned
        };
        // Flipping x alone takes phi to pi - phi: half a turn, then mirrored.
        mirrored % count
    }
}

/// The images under which an anisotropic sample looks the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Images {
    /// None.
    #[default]
    None,
    /// Mirrored at one plane.
    Bilateral(Image),
    /// Turned by pi.
    HalfTurn,
    /// Mirrored at both planes.
    Quadrilateral,
}

impl Images {
    /// The group of what was found: two of the three images make the third.
    pub(crate) fn of(flip_x: bool, flip_y: bool, half_turn: bool) -> Self {
        match (flip_x, flip_y, half_turn) {
            (true, true, _) | (true, _, true) | (_, true, true) => Images::Quadrilateral,
            (true, ..) => Images::Bilateral(Image::FLIP_X),
            (_, true, _) => Images::Bilateral(Image::FLIP_Y),
            (.., true) => Images::HalfTurn,
            _ => Images::None,
        }
    }

    /// Every image, the direction itself first.
    pub(crate) fn iter(self) -> impl Iterator<Item = Image> {
        let more = match self {
            Images::None => [None; 3],
            Images::Bilateral(image) => [Some(image), None, None],
            Images::HalfTurn => [Some(Image::HALF_TURN), None, None],
            Images::Quadrilateral => [Some(Image::FLIP_X), Some(Image::FLIP_Y), Some(Image::HALF_TURN)],
        };
        std::iter::once(Image::SAME).chain(more.into_iter().flatten())
    }

    /// Name used in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Images::None => "anisotropic",
            Images::Bilateral(_) => "bilateral",
            Images::HalfTurn => "half-turn",
            Images::Quadrilateral => "quadrilateral",
        }
    }
}

/// What a sample looks like under rotations and reflections about the normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// Only the difference of azimuths matters.
    Isotropic,
    /// The sample has axes, and some images.
    Axes(Images),
}

impl Symmetry {
    pub(crate) fn is_isotropic(self) -> bool {
        self == Symmetry::Isotropic
    }

    /// Name used in reports.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Symmetry::Isotropic => "isotropic",
            Symmetry::Axes(images) => images.name(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_images_make_the_third_and_each_undoes_itself() {
        assert_eq!(Images::of(true, false, true), Images::Quadrilateral);
        assert_eq!(Images::of(false, false, true), Images::HalfTurn);
        let v = DVec3::new(0.3, -0.4, 0.8);
        for image in Images::Quadrilateral.iter() {
            assert_eq!(image.of(image.of(v)), v);
        }
        assert_eq!(Images::Quadrilateral.iter().count(), 4);
        assert_eq!(Images::None.iter().count(), 1);
    }
}
