//! Writing tensor files.

use std::path::Path;

use super::{MAGIC, NumberType};
use crate::{IoError, write_atomic};

/// A named array to write.
#[derive(Clone, Copy, Debug)]
pub struct NewField<'a> {
    /// Its name, at most 65535 bytes.
    pub name: &'a str,
    /// Length of each dimension, the last one contiguous.
    pub shape: &'a [usize],
    /// The numbers.
    pub data: Data<'a>,
}

/// Numbers of a field.
#[derive(Clone, Copy, Debug)]
pub enum Data<'a> {
    /// `float32`.
    Floats(&'a [f32]),
    /// `uint8`.
    Bytes(&'a [u8]),
}

impl Data<'_> {
    fn number(&self) -> NumberType {
        match self {
            Data::Floats(_) => NumberType::F32,
            Data::Bytes(_) => NumberType::U8,
        }
    }

    fn len(&self) -> usize {
        match self {
            Data::Floats(values) => values.len(),
            Data::Bytes(bytes) => bytes.len(),
        }
    }
}

/// Writes the fields in their order, data behind all headers.
///
/// # Errors
/// [`IoError::Format`] for a field whose numbers are not as many as its shape says, with more dimensions than
/// [`TensorFile`](super::TensorFile) reads, or of too long a name; refusals of the operating system.
pub fn write(path: &Path, fields: &[NewField<'_>]) -> Result<(), IoError> {
    let mut header: Vec<u8> = MAGIC.to_vec();
    header.extend([1, 0]);
    header.extend((fields.len() as u32).to_le_bytes());
    let size = |f: &NewField<'_>| 13 + f.name.len() + 8 * f.shape.len();
    let mut offset = (header.len() + fields.iter().map(size).sum::<usize>()) as u64;
    for field in fields {
        let wrong = |found: String, allowed: String| IoError::format(path, None, field.name, found, allowed);
        let product = field.shape.iter().try_fold(1usize, |a, b| a.checked_mul(*b));
        if product != Some(field.data.len()) {
            let found = format!("{} numbers", field.data.len());
            return Err(wrong(
                found,
                format!("as many as the shape {:?} says", field.shape),
            ));
        }
        if field.shape.len() > usize::from(super::MAX_DIMENSIONS) {
            let found = format!("{} dimensions", field.shape.len());
            return Err(wrong(found, format!("up to {}", super::MAX_DIMENSIONS)));
        }
        let Ok(length) = u16::try_from(field.name.len()) else {
            return Err(wrong(
                format!("a name of {} bytes", field.name.len()),
                "up to 65535".into(),
            ));
        };
        let number = field.data.number();
        header.extend(length.to_le_bytes());
        header.extend(field.name.as_bytes());
        header.extend((field.shape.len() as u16).to_le_bytes());
        header.push(number.code());
        header.extend(offset.to_le_bytes());
        field
            .shape
            .iter()
            .for_each(|d| header.extend((*d as u64).to_le_bytes()));
        offset += (field.data.len() * number.size()) as u64;
    }
    write_atomic(path, |out| {
        out.write_all(&header)?;
        for field in fields {
            match field.data {
                Data::Bytes(bytes) => out.write_all(bytes)?,
                Data::Floats(values) => {
                    for v in values {
                        out.write_all(&v.to_le_bytes())?;
                    }
                }
            }
        }
        Ok(())
    })
}
