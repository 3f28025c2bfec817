//! The tensor container of the RGL material database (`.bsdf`): named arrays of any shape and number type.
//!
//! Little endian: `tensor_file` and a zero byte, version (two bytes, 1 and 0), number of fields (u32); for each field
//! the length of its name (u16), the name, the number of dimensions (u16), the code of the number type (u8), the
//! offset of the data from the start of the file (u64) and the dimensions (u64 each). Data stand anywhere behind.

mod write;

use std::io::Read;
use std::path::Path;

use crate::error::open;
use crate::{IoError, excerpt};
pub use write::{Data, NewField, write};

/// First bytes of a tensor file.
pub const MAGIC: &[u8] = b"tensor_file\0";

/// Whether the file begins as a tensor file does.
///
/// # Errors
/// [`IoError::File`] for refusals of the operating system.
pub fn is_tensor_file(path: &Path) -> Result<bool, IoError> {
    let mut head = Vec::with_capacity(MAGIC.len());
    open(path)?
        .0
        .take(MAGIC.len() as u64)
        .read_to_end(&mut head)
        .map_err(|e| IoError::file(path, e))?;
    Ok(head == MAGIC)
}

/// Most fields and dimensions that are read; real files have about a dozen and five.
const MAX_FIELDS: u32 = 4096;
const MAX_DIMENSIONS: u16 = 16;

/// Type of the numbers of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// Unsigned byte.
    U8,
    /// Signed byte.
    I8,
    /// Unsigned, two bytes.
    U16,
    /// Signed, two bytes.
    I16,
    /// Unsigned, four bytes.
    U32,
    /// Signed, four bytes.
    I32,
    /// Unsigned, eight bytes.
    U64,
    /// Signed, eight bytes.
    I64,
    /// Floating point, two bytes.
    F16,
    /// Floating point, four bytes.
    F32,
    /// Floating point, eight bytes.
    F64,
}

impl NumberType {
    /// Code in the file, name, bytes a number.
    const ALL: [(u8, NumberType, &'static str, usize); 11] = [
        (1, NumberType::U8, "uint8", 1),
        (2, NumberType::I8, "int8", 1),
        (3, NumberType::U16, "uint16", 2),
        (4, NumberType::I16, "int16", 2),
        (5, NumberType::U32, "uint32", 4),
        (6, NumberType::I32, "int32", 4),
        (7, NumberType::U64, "uint64", 8),
        (8, NumberType::I64, "int64", 8),
        (9, NumberType::F16, "float16", 2),
        (10, NumberType::F32, "float32", 4),
        (11, NumberType::F64, "float64", 8),
    ];

    fn from_code(code: u8) -> Option<Self> {
        Self::ALL.iter().find(|row| row.0 == code).map(|row| row.1)
    }

    /// Code in the file.
    fn code(self) -> u8 {
        Self::ALL.iter().find(|row| row.1 == self).map_or(0, |row| row.0)
    }

    fn row(self) -> (&'static str, usize) {
        Self::ALL
            .iter()
            .find(|row| row.1 == self)
            .map_or(("", 1), |row| (row.2, row.3))
    }

    /// Name as numpy has it.
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// Bytes a number.
    pub fn size(self) -> usize {
        self.row().1
    }
}

/// A named array; its numbers stay in the bytes of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Field<'a> {
    /// Its name.
    pub name: String,
    /// Type of its numbers.
    pub number: NumberType,
    /// Length of each dimension, the last one contiguous.
    pub shape: Vec<usize>,
    /// The numbers, little endian, `size * product of shape` bytes.
    pub data: &'a [u8],
}

impl Field<'_> {
    /// Number of numbers.
    pub fn len(&self) -> usize {
        self.data.len() / self.number.size()
    }

    /// Whether there is no number.
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    /// The numbers of a `float32` field; `None` for another type.
    pub fn floats(&self) -> Option<Vec<f32>> {
        if self.number != NumberType::F32 {
            return None;
        }
        let (four, _) = self.data.as_chunks::<4>();
        Some(four.iter().map(|b| f32::from_le_bytes(*b)).collect())
    }

    /// The numbers of a `uint8` field; `None` for another type.
    pub fn bytes(&self) -> Option<&[u8]> {
        (self.number == NumberType::U8).then_some(self.data)
    }
}

/// The fields of a file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct TensorFile<'a> {
    /// The fields in the order of the file.
    pub fields: Vec<Field<'a>>,
}

impl<'a> TensorFile<'a> {
    /// The fields of `bytes`; `path` is named in errors. Nothing is copied, and no size of the file is believed before
    /// it has been compared with the length of `bytes`.
    ///
    /// # Errors
    /// [`IoError::Format`] that names the field for another beginning or version, a header that ends early, a name that
    /// is no UTF-8 or stands twice, an unknown number type, data that do not lie within the file.
    pub fn parse(bytes: &'a [u8], path: &Path) -> Result<Self, IoError> {
        let mut header = Header { bytes, at: 0, path };
        let magic = header.take("file", MAGIC.len())?;
        if magic != MAGIC {
            return Err(header.wrong("file", excerpt(magic), "a tensor file, beginning \"tensor_file\""));
        }
        let version = header.array::<2>("version")?;
        if version != [1, 0] {
            let found = format!("{}.{}", version[0], version[1]);
            return Err(header.wrong("version", found, "1.0"));
        }
        let count = u32::from_le_bytes(header.array("number of fields")?);
        if count > MAX_FIELDS {
            let allowed = format!("up to {MAX_FIELDS}");
            return Err(header.wrong("number of fields", count.to_string(), &allowed));
        }
        let mut fields: Vec<Field<'a>> = Vec::new();
        for k in 0..count {
            let field = header.field(k)?;
            if fields.iter().any(|f| f.name == field.name) {
                return Err(header.wrong(&field.name, "the field twice".into(), "each field once"));
            }
            fields.push(field);
        }
        Ok(TensorFile { fields })
    }

    /// The field of that name.
    pub fn field(&self, name: &str) -> Option<&Field<'a>> {
        self.fields.iter().find(|f| f.name == name)
    }
}

/// The place in the header.
struct Header<'a, 'p> {
    bytes: &'a [u8],
    at: usize,
    path: &'p Path,
}

impl<'a> Header<'a, '_> {
    fn wrong(&self, field: &str, found: String, allowed: &str) -> IoError {
        IoError::format(self.path, None, field, found, allowed)
    }

    fn take(&mut self, field: &str, n: usize) -> Result<&'a [u8], IoError> {
        let rest = &self.bytes[self.at..];
        match rest.get(..n) {
            Some(taken) => {
                self.at += n;
                Ok(taken)
            }
            None => Err(self.wrong(
                field,
                format!("the end of the file after {} bytes", self.bytes.len()),
                &format!("{n} bytes from byte {} on", self.at),
            )),
        }
    }

    fn array<const N: usize>(&mut self, field: &str) -> Result<[u8; N], IoError> {
        let mut out = [0; N];
        out.copy_from_slice(self.take(field, N)?);
        Ok(out)
    }

    fn field(&mut self, k: u32) -> Result<Field<'a>, IoError> {
        let place = format!("field {}", k + 1);
        let length = u16::from_le_bytes(self.array(&place)?);
        let name = self.take(&place, usize::from(length))?;
        let name = std::str::from_utf8(name)
            .map_err(|_| self.wrong(&place, format!("the name {}", excerpt(name)), "a name in UTF-8"))?
            .to_owned();
        let dimensions = u16::from_le_bytes(self.array(&name)?);
        if dimensions > MAX_DIMENSIONS {
            let found = format!("{dimensions} dimensions");
            return Err(self.wrong(&name, found, &format!("up to {MAX_DIMENSIONS} dimensions")));
        }
        let [code] = self.array(&name)?;
        let number = NumberType::from_code(code)
            .ok_or_else(|| self.wrong(&name, format!("number type {code}"), "number types 1 to 11"))?;
        let offset = u64::from_le_bytes(self.array(&name)?);
        let mut shape = Vec::with_capacity(usize::from(dimensions));
        let mut size = Some(number.size() as u64);
        for _ in 0..dimensions {
            let d = u64::from_le_bytes(self.array(&name)?);
            size = size.and_then(|s| s.checked_mul(d));
            // a length that does not fit is found out by the size, unless another one is zero
            shape.push(usize::try_from(d).unwrap_or(usize::MAX));
        }
        let data = size
            .and_then(|s| Some((usize::try_from(offset).ok()?, usize::try_from(s).ok()?)))
            .and_then(|(from, n)| self.bytes.get(from..from.checked_add(n)?));
        match data {
            Some(data) => Ok(Field {
                name,
                number,
                shape,
                data,
            }),
            None => Err(self.wrong(
                &name,
                format!("{} of shape {shape:?} at byte {offset}", number.name()),
                &format!("data within the {} bytes of the file", self.bytes.len()),
            )),
        }
    }
}

#[cfg(test)]
pub(crate) mod tests;
