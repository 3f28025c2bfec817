/// What the variables of a ray are at one point. Vectors are in the coordinates of the function: where a primitive turns or
/// scales its pattern, the caller has already taken world to pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// `Dx`, `Dy`, `Dz`: unit direction of the ray.
    pub direction: [f64; 3],
    /// `Nx`, `Ny`, `Nz`: unit normal of the surface.
    pub normal: [f64; 3],
    /// `Px`, `Py`, `Pz`: where the ray meets the surface.
    pub position: [f64; 3],
    /// `T`: length of the path since the eye.
    pub distance: f64,
    /// `Ts`: length of this ray alone.
    pub ray_distance: f64,
    /// `Rdot`: cosine between the ray turned back and the normal.
    pub rdot: f64,
    /// `S`: scale of the world in the pattern.
    pub scale: f64,
    /// `Tx`, `Ty`, `Tz`: origin of the world.
    pub origin: [f64; 3],
    /// `Ix` to `Kz`: unit vectors of the world.
    pub axes: [[f64; 3]; 3],
    /// `Lu`, `Lv`: coordinates of a mesh on its surface.
    pub uv: [f64; 2],
    /// `NxP`, `NyP`, `NzP`: normal after textures.
    pub perturbed_normal: [f64; 3],
    /// `RdotP`: cosine to the normal after textures.
    pub perturbed_rdot: f64,
    /// `CrP`, `CgP`, `CbP`: colour after patterns.
    pub colour: [f64; 3],
    /// `DxA`, `DyA`, `DzA`: direction to the light a prism is asked for.
    pub target: [f64; 3],
}

impl Default for Point {
    /// A ray straight down onto the origin of a level surface, in world coordinates.
    fn default() -> Self {
        Point {
            direction: [0.0, 0.0, -1.0],
            normal: [0.0, 0.0, 1.0],
            position: [0.0; 3],
            distance: 0.0,
            ray_distance: 0.0,
            rdot: 1.0,
            scale: 1.0,
            origin: [0.0; 3],
            axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            uv: [0.0; 2],
            perturbed_normal: [0.0, 0.0, 1.0],
            perturbed_rdot: 1.0,
            colour: [1.0; 3],
            target: [0.0; 3],
        }
    }
}

/// A variable of the ray: which vector, which component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ray {
    Direction(u8),
    Normal(u8),
    Position(u8),
    Distance,
    Segment,
    Rdot,
    Scale,
    Origin(u8),
    Axis(u8, u8),
    Local(u8),
    PerturbedNormal(u8),
    PerturbedRdot,
    Colour(u8),
    Target(u8),
}

impl Ray {
    pub(super) fn named(name: &str) -> Option<Self> {
        let component = |c: u8, first: u8| c.checked_sub(first).filter(|k| *k < 3);
        Some(match name.as_bytes() {
            b"T" => Ray::Distance,
            b"Ts" => Ray::Segment,
            b"S" => Ray::Scale,
            b"Rdot" => Ray::Rdot,
            b"RdotP" => Ray::PerturbedRdot,
            b"Lu" => Ray::Local(0),
            b"Lv" => Ray::Local(1),
            b"CrP" => Ray::Colour(0),
            b"CgP" => Ray::Colour(1),
            b"CbP" => Ray::Colour(2),
            [b'D', c] => Ray::Direction(component(*c, b'x')?),
            [b'N', c] => Ray::Normal(component(*c, b'x')?),
            [b'P', c] => Ray::Position(component(*c, b'x')?),
            [b'T', c] => Ray::Origin(component(*c, b'x')?),
            [axis @ b'I'..=b'K', c] => Ray::Axis(axis - b'I', component(*c, b'x')?),
            [b'N', c, b'P'] => Ray::PerturbedNormal(component(*c, b'x')?),
            [b'D', c, b'A'] => Ray::Target(component(*c, b'x')?),
            _ => return None,
        })
    }

    #[inline]
    pub(super) fn of(self, p: &Point) -> f64 {
        match self {
            Ray::Direction(k) => p.direction[k as usize],
            Ray::Normal(k) => p.normal[k as usize],
            Ray::Position(k) => p.position[k as usize],
            Ray::Distance => p.distance,
            Ray::Segment => p.ray_distance,
            Ray::Rdot => p.rdot,
            Ray::Scale => p.scale,
            Ray::Origin(k) => p.origin[k as usize],
            Ray::Axis(axis, k) => p.axes[axis as usize][k as usize],
            Ray::Local(k) => p.uv[k as usize],
            Ray::PerturbedNormal(k) => p.perturbed_normal[k as usize],
            Ray::PerturbedRdot => p.perturbed_rdot,
            Ray::Colour(k) => p.colour[k as usize],
            Ray::Target(k) => p.target[k as usize],
        }
    }
}
