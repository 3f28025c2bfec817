//! Pictures of radiance: RADIANCE's `.hdr` and OpenEXR.

mod exr;
mod hdr;
mod hdr_read;

pub use exr::write_exr;
pub use hdr::write_hdr;
pub use hdr_read::{ReadPicture, read_hdr, read_hdr_from};

/// Luminance over radiance of white: 179 lm/W, as RADIANCE has it.
const WHITE_EFFICACY: f32 = 179.0;

/// A picture with all that is known of its pixels, row by row from the top left.
#[derive(Clone, Copy, Debug)]
pub struct Picture<'a> {
    /// Pixels across; the lists below are as long as width times height.
    pub width: usize,
    /// Red, green and blue radiance, W/(m2 sr), in RADIANCE's primaries.
    pub radiance: &'a [[f32; 3]],
    /// Luminance, cd/m2.
    pub luminance: &'a [f32],
    /// Its standard error, cd/m2; infinite where it is not known.
    pub standard_error: &'a [f32],
    /// The view, by RADIANCE's options (`-vtv -vp …`).
    pub view: &'a str,
    /// Program and version.
    pub software: &'a str,
}

impl Picture<'_> {
    fn height(&self) -> usize {
        self.radiance.len() / self.width.max(1)
    }

    /// Whether it has pixels, and as many in every layer.
    fn is_whole(&self) -> bool {
        let n = self.radiance.len();
        n > 0
            && n == self.width * self.height()
            && self.luminance.len() == n
            && self.standard_error.len() == n
    }

    fn check(&self) -> std::io::Result<()> {
        if self.is_whole() {
            return Ok(());
        }
        Err(std::io::Error::new(
            std::io::ErrorKind::InvalidInput,
            format!(
                "picture of {} pixels, {} across, {} luminances, {} errors: allowed whole rows of as many",
                self.radiance.len(),
                self.width,
                self.luminance.len(),
                self.standard_error.len()
            ),
        ))
    }
}
