//! OpenEXR: radiance, luminance and standard error in single precision.

use std::io::Cursor;
use std::path::Path;

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{Chromaticities, Text};
use exr::meta::header::LayerAttributes;
use exr::prelude::{SmallVec, WritableImage};

use super::{Picture, WHITE_EFFICACY};
use crate::IoError;
use crate::atomic::write_atomic;

/// Channels of what is not the picture itself.
const LUMINANCE: &str = "luminance.Y";
const ERROR: &str = "standard_error.Y";

/// Writes a picture: `R`, `G`, `B` in W/(m2 sr), `luminance.Y` and `standard_error.Y` in cd/m2. The header states RADIANCE's
/// primaries and the luminance of white, 179 cd/m2; the comment is the view.
///
/// # Errors
/// [`IoError::File`] where the file system refuses, and for a picture whose layers are not equally long.
pub fn write_exr(path: &Path, picture: &Picture<'_>) -> Result<(), IoError> {
    write_atomic(path, |out| {
        picture.check()?;
        let layer = |name: &str, values: Vec<f32>| AnyChannel::new(name, FlatSamples::F32(values));
        let colour = |k: usize| picture.radiance.iter().map(|c| c[k]).collect();
        let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = [
            layer("R", colour(0)),
            layer("G", colour(1)),
            layer("B", colour(2)),
            layer(LUMINANCE, picture.luminance.to_vec()),
            layer(ERROR, picture.standard_error.to_vec()),
        ]
        .into_iter()
        .collect();
        let attributes = LayerAttributes {
            software_name: Text::new_or_none(picture.software),
            comments: Text::new_or_none(format!("VIEW= {}", picture.view)),
            white_luminance: Some(WHITE_EFFICACY),
            ..LayerAttributes::default()
        };
        let mut image = Image::from_layer(Layer::new(
            (picture.width, picture.height()),
            attributes,
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(channels),
        ));
        image.attributes.chromaticities = Some(Chromaticities {
            red: Vec2(0.640, 0.330),
            green: Vec2(0.290, 0.600),
            blue: Vec2(0.150, 0.060),
            white: Vec2(1.0 / 3.0, 1.0 / 3.0),
        });
        let mut bytes = Cursor::new(Vec::new());
        image
            .write()
            .to_buffered(&mut bytes)
            .map_err(std::io::Error::other)?;
        out.write_all(bytes.get_ref())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_what_was_written() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.exr");
        let radiance: Vec<[f32; 3]> = (0..70 * 3)
            .map(|k| [k as f32, 1e6 / (1 + k) as f32, 0.0])
            .collect();
        let luminance: Vec<f32> = radiance.iter().map(|c| 100.0 * c[0]).collect();
        let mut standard_error = vec![0.25; 210];
        standard_error[3] = f32::INFINITY;
        let picture = Picture {
            width: 70,
            radiance: &radiance,
            luminance: &luminance,
            standard_error: &standard_error,
            view: "-vtv",
            software: "gonio test",
        };
        write_exr(&path, &picture).unwrap();
        let read = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
        assert_eq!(read.layer_data.size, Vec2(70, 3));
        let values = |name: &str| -> Vec<f32> {
            let channel = read.layer_data.channel_data.list.iter().find(|c| c.name == *name);
            channel.unwrap().sample_data.values_as_f32().collect()
        };
        assert_eq!(values("G"), radiance.iter().map(|c| c[1]).collect::<Vec<_>>());
        assert_eq!(values(LUMINANCE), luminance);
        assert_eq!(values(ERROR), standard_error);
        assert_eq!(read.layer_data.attributes.white_luminance, Some(179.0));
        let short = Picture {
            luminance: &luminance[1..],
            ..picture
        };
        assert!(write_exr(&path, &short).is_err());
    }
}
