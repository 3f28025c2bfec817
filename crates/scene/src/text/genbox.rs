//! The box of `genbox` [Radiance, gen/genbox.c].

use gonio_io::radiance_material::{Body, Item};

/// Corners of the six faces; bit 0 is x, bit 1 y, bit 2 z.
const FACES: [[usize; 4]; 6] = [
    [1, 5, 4, 0],
    [4, 6, 2, 0],
    [2, 3, 1, 0],
    [3, 2, 6, 7],
    [5, 1, 3, 7],
    [6, 4, 5, 7],
];

/// The polygons of `genbox material name x y z [-i]`; `words` are what follows `genbox`.
///
/// # Errors
/// What is wrong, and what is allowed.
pub(super) fn genbox(words: &[String]) -> Result<Vec<Item>, (String, &'static str)> {
    const USAGE: &str = "genbox material name xsize ysize zsize [-i]";
    let [material, name, sizes @ ..] = words else {
        return Err((words.join(" "), USAGE));
    };
    let (sizes, options) = sizes
        .split_at_checked(3)
        .ok_or_else(|| (words.join(" "), USAGE))?;
    let mut size = [0.0; 3];
    for (s, word) in size.iter_mut().zip(sizes) {
        *s = word
            .parse::<f64>()
            .ok()
            .filter(|v| *v > 0.0 && v.is_finite())
            .ok_or_else(|| (word.clone(), "sizes above 0"))?;
    }
    let mut inward = false;
    for option in options {
        match option.as_str() {
            "-i" => inward = true,
            "-b" | "-r" => return Err((option.clone(), "-i: bevelled and rounded boxes are not made")),
            _ => return Err((option.clone(), USAGE)),
        }
    }
    let corner = |v: usize| (0..3).map(move |k| if (v >> k & 1 == 1) != inward { size[k] } else { 0.0 });
    Ok(FACES
        .iter()
        .map(|face| {
            let digits: String = face.iter().map(|v| char::from(b'0' + *v as u8)).collect();
            Item {
                modifier: material.clone(),
                id: format!("{name}.{digits}"),
                body: Body::Other {
                    type_word: "polygon".into(),
                    strings: vec![],
                    integers: vec![],
                    reals: face.iter().flat_map(|v| corner(*v)).collect(),
                },
                line: 0,
            }
        })
        .collect())
}
