use std::path::Path;

use super::*;

/// A file of `(name, code, shape, data)`.
pub(crate) fn written(fields: &[(&str, u8, Vec<u64>, Vec<u8>)]) -> Vec<u8> {
    let header: usize = fields.iter().map(|f| 13 + f.0.len() + 8 * f.2.len()).sum();
    let mut offset = MAGIC.len() + 6 + header;
    let mut out = MAGIC.to_vec();
    out.extend([1, 0]);
    out.extend((fields.len() as u32).to_le_bytes());
    for (name, code, shape, data) in fields {
        out.extend((name.len() as u16).to_le_bytes());
        out.extend(name.as_bytes());
        out.extend((shape.len() as u16).to_le_bytes());
        out.push(*code);
        out.extend((offset as u64).to_le_bytes());
        shape.iter().for_each(|d| out.extend(d.to_le_bytes()));
        offset += data.len();
    }
    fields.iter().for_each(|f| out.extend(&f.3));
    out
}

fn small() -> Vec<u8> {
    let floats: Vec<u8> = (0..6).flat_map(|k| (k as f32 / 2.0).to_le_bytes()).collect();
    written(&[
        ("table", 10, vec![2, 3], floats),
        ("text", 1, vec![5], b"hello".to_vec()),
        ("scalar", 11, vec![], 2.5f64.to_le_bytes().to_vec()),
        ("nothing", 10, vec![0, 7], vec![]),
    ])
}

fn refused(bytes: &[u8]) -> String {
    TensorFile::parse(bytes, Path::new("a.bsdf"))
        .unwrap_err()
        .to_string()
}

#[test]
fn fields_come_back_with_shape_type_and_numbers() {
    let bytes = small();
    let file = TensorFile::parse(&bytes, Path::new("a.bsdf")).unwrap();
    assert_eq!(file.fields.len(), 4);
    let table = file.field("table").unwrap();
    assert_eq!((table.shape.as_slice(), table.len()), (&[2, 3][..], 6));
    assert_eq!(table.floats().unwrap(), [0.0, 0.5, 1.0, 1.5, 2.0, 2.5]);
    assert_eq!(table.bytes(), None);
    let text = file.field("text").unwrap();
    assert_eq!(text.bytes(), Some(&b"hello"[..]));
    assert_eq!(text.floats(), None);
    let scalar = file.field("scalar").unwrap();
    assert_eq!((scalar.number, scalar.len()), (NumberType::F64, 1));
    assert!(file.field("nothing").unwrap().is_empty() && file.field("other").is_none());
}

#[test]
fn a_written_file_is_the_one_that_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.bsdf");
    let floats = [0.5f32, -1.0, 2.0, 3.5, 0.0, 9.0];
    let field = |name, shape, data| NewField { name, shape, data };
    let fields = [
        field("table", &[2, 3][..], Data::Floats(&floats)),
        field("text", &[5], Data::Bytes(b"hello")),
        field("nothing", &[0, 7], Data::Floats(&[])),
    ];
    write(&path, &fields).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let file = TensorFile::parse(&bytes, &path).unwrap();
    assert_eq!(file.field("table").unwrap().floats().unwrap(), floats);
    assert_eq!(file.field("table").unwrap().shape, [2, 3]);
    assert_eq!(file.field("text").unwrap().bytes(), Some(&b"hello"[..]));
    assert!(file.field("nothing").unwrap().is_empty());
    let short = [field("table", &[2, 2][..], Data::Floats(&floats))];
    let text = write(&path, &short).unwrap_err().to_string();
    assert!(text.contains("table: found 6 numbers"), "{text}");
    assert_eq!(std::fs::read(&path).unwrap(), bytes);
}

#[test]
fn faults_are_told_with_field_and_what_was_found() {
    let whole = small();
    let spoilt = |at: usize, with: &[u8]| {
        let mut bytes = whole.clone();
        bytes[at..at + with.len()].copy_from_slice(with);
        refused(&bytes)
    };
    let table = MAGIC.len() + 6 + 2 + 5;
    for (text, words) in [
        (refused(b""), ["file: found the end", "12 bytes"]),
        (refused(b"<?xml version='1'"), ["file: found", "tensor_file"]),
        (spoilt(12, &[2, 7]), ["version: found 2.7", "allowed 1.0"]),
        (
            spoilt(14, &[0xff; 4]),
            ["number of fields: found 4294967295", "4096"],
        ),
        (spoilt(18, &[0xff; 2]), ["field 1: found the end", "65535 bytes"]),
        (spoilt(20, &[0xff]), ["field 1: found the name", "UTF-8"]),
        (spoilt(table, &[99]), ["table: found 99 dimensions", "up to 16"]),
        (
            spoilt(table + 2, &[12]),
            ["table: found number type 12", "1 to 11"],
        ),
        (
            spoilt(table + 3, &[0xff; 8]),
            ["table: found float32", "data within"],
        ),
        (
            spoilt(table + 11, &[0xff; 8]),
            ["table: found float32", "data within"],
        ),
        (
            spoilt(table + 11, &[99]),
            ["table: found float32 of shape [99, 3]", "data within"],
        ),
    ] {
        assert!(text.starts_with("a.bsdf: "), "{text}");
        assert!(words.iter().all(|w| text.contains(w)), "{text}");
    }
    let twice = written(&[("a", 1, vec![1], vec![0]), ("a", 1, vec![1], vec![0])]);
    assert!(refused(&twice).contains("a: found the field twice"));
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let whole = small();
    for n in 0..whole.len() {
        refused(&whole[..n]);
    }
}
