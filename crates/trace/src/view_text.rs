//! Views as RADIANCE's headers have them: `-vtv -vp 0 0 1 -vd 0 1 0 …`.

use std::fmt;

use crate::camera::{Projection, View};

const TYPES: [(char, Projection); 6] = [
    ('v', Projection::Perspective),
    ('l', Projection::Parallel),
    ('h', Projection::Hemispherical),
    ('a', Projection::Angular),
    ('s', Projection::Planisphere),
    ('c', Projection::Cylindrical),
];

impl fmt::Display for View {
    /// The options, all of them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let letter = TYPES.iter().find(|t| t.1 == self.projection).map_or('v', |t| t.0);
        let (p, d, u) = (self.point, self.direction, self.up);
        write!(
            f,
            "-vt{letter} -vp {} {} {} -vd {} {} {} -vu {} {} {} -vh {} -vv {} -vo {} -va {} -vs {} -vl {}",
            p.x,
            p.y,
            p.z,
            d.x,
            d.y,
            d.z,
            u.x,
            u.y,
            u.z,
            self.horizontal,
            self.vertical,
            self.fore,
            self.aft,
            self.shift[0],
            self.shift[1]
        )
    }
}
