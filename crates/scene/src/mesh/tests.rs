use std::path::Path;

use base64::Engine;

use super::*;

fn read_as(name: &str, bytes: &[u8]) -> Result<Mesh, String> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    let folder = format!("{}/", dir.path().display());
    read(&path).map_err(|e| e.to_string().replace(&folder, ""))
}

/// One triangle in the plane z = 0 of glTF's axes, facing +z, with normals; below a node that scales by 2.
fn gltf(change: impl Fn(String) -> String) -> Vec<u8> {
    let mut bytes = Vec::new();
    for x in [
        0.0_f32, 0., 0., 1., 0., 0., 0., 1., 0., 0., 0., 1., 0., 0., 1., 0., 0., 1.,
    ] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend([0, 0, 1, 0, 2, 0]);
    let data = base64::engine::general_purpose::STANDARD.encode(bytes);
    let text = format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"children": [1], "scale": [2, 2, 2]}}, {{"mesh": 0, "translation": [0, 3, 0]}}],
        "materials": [{{"name": "paint"}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "NORMAL": 1}}, "indices": 2, "material": 0}}]}}],
        "accessors": [
          {{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}},
          {{"bufferView": 0, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"}},
          {{"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 72}}, {{"buffer": 0, "byteOffset": 72, "byteLength": 6}}],
        "buffers": [{{"byteLength": 78, "uri": "data:application/octet-stream;base64,{data}"}}]}}"#
    );
    change(text).into_bytes()
}

#[test]
fn gltf_stands_upright_in_the_place_of_its_nodes() {
    let mesh = read_as("a.gltf", &gltf(|t| t)).unwrap();
    // x stays, y becomes z, z becomes -y.
    let wanted = [[0.0, 0.0, 6.0], [2.0, 0.0, 6.0], [0.0, 0.0, 8.0]].map(DVec3::from);
    assert_eq!(mesh.points, wanted);
    assert_eq!(mesh.normals, [Vec3::NEG_Y; 3]);
    assert_eq!(mesh.triangles, [[0, 1, 2]]);
    assert_eq!(mesh.pieces().collect::<Vec<_>>(), [("paint", 0..1)]);
    let mirrored = read_as("a.gltf", &gltf(|t| t.replace("[2, 2, 2]", "[-2, 2, 2]"))).unwrap();
    assert_eq!(mirrored.triangles, [[0, 2, 1]]);
    let strip = r#""mode": 5, "attributes""#;
    let strip = read_as("a.gltf", &gltf(|t| t.replace("\"attributes\"", strip))).unwrap();
    assert_eq!(strip.triangles, [[0, 1, 2]]);
    let points = r#""mode": 0, "attributes""#;
    let points = read_as("a.gltf", &gltf(|t| t.replace("\"attributes\"", points))).unwrap();
    assert!(points.triangles.is_empty());
}

#[test]
fn damaged_gltf_is_refused() {
    for (from, to) in [
        ("\"nodes\": [0]", "\"nodes\": [7]"),
        ("\"children\": [1]", "\"children\": [0]"),
        ("\"count\": 3", "\"count\": 4000000000"),
        ("\"byteOffset\": 36", "\"byteOffset\": 360"),
        ("\"byteOffset\": 72", "\"byteOffset\": 70"),
        ("\"byteLength\": 72}", "\"byteLength\": 72, \"byteStride\": 252}"),
        ("\"buffer\": 0", "\"buffer\": 3"),
        ("\"type\": \"VEC3\", \"min\"", "\"type\": \"VEC4\", \"min\""),
        ("5123", "5126"),
        ("base64,", "utf8,"),
        ("base64,", "base64,****"),
        ("data:application/octet-stream;base64,", "https://example.org/"),
        ("\"2.0\"", "2"),
    ] {
        let made = gltf(|t| t.replace(from, to));
        let e = read_as("a.gltf", &made)
            .err()
            .unwrap_or_else(|| panic!("{from} {to}"));
        assert!(e.starts_with("a.gltf: "), "{e}");
    }
    for bytes in [&b""[..], b"{}", b"glTF\x02\0\0\0\xff\xff\xff\xffJSON", b"[[[[["] {
        assert!(read_as("a.glb", bytes).is_err());
    }
    let e = read_as("a.glb", b"glTF\x02\0\0\0\x0b\0\0\0JSON").unwrap_err();
    assert!(e.contains("length: found 11, allowed"), "{e}");
}

#[test]
fn materials_and_normals_of_obj_and_normals_of_ply_are_kept() {
    let obj = "mtllib x.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0 3 4\nusemtl red wood\nf 1//1 2//1 3//2\nusemtl b\n\
               f 1//1 3//2 4//1\nf 1 2 4\n";
    let mesh = read_as("a.obj", obj.as_bytes()).unwrap();
    let pieces: Vec<_> = mesh.pieces().collect();
    assert_eq!(pieces, [("red wood", 0..1), ("b", 1..3)]);
    assert_eq!(mesh.normals.len(), mesh.points.len());
    let seen: Vec<Vec3> = mesh.triangles[0]
        .iter()
        .map(|k| mesh.normals[*k as usize])
        .collect();
    assert_eq!(seen, [Vec3::Z, Vec3::Z, Vec3::new(0.0, 0.6, 0.8)]);
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               property float nx\nproperty float ny\nproperty float nz\nelement face 1\n\
               property list uchar int vertex_indices\nend_header\n0 0 0 0 0 2\n1 0 0 0 0 2\n0 1 0 0 0 0\n3 0 1 2\n";
    let mesh = read_as("a.ply", ply.as_bytes()).unwrap();
    assert_eq!(mesh.normals, [Vec3::Z, Vec3::Z, Vec3::ZERO]);
}

#[test]
fn numbers_of_a_ply_may_begin_with_the_point() {
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
               element face 1\nproperty list uchar int vertex_index\nend_header\n\
               .5 -.25 0\n1.5 0 0\n0 1 -.125\n3 0 1 2\n";
    let mesh = read_as("a.ply", ply.as_bytes()).unwrap();
    assert_eq!(mesh.points[0].to_array(), [0.5, -0.25, 0.0]);
    assert_eq!(mesh.points[2].to_array(), [0.0, 1.0, -0.125]);
}

#[test]
fn faults_of_an_obj_name_its_line() {
    for (text, line) in [
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\n\nf 1 2 4\n", 5),
        ("v 0 0 0\nv 1 x 0\nv 0 1 0\nf 1 2 3\n", 2),
        ("f 1 2 3\n", 1),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 0 3\n", 4),
    ] {
        let e = read_as("a.obj", text.as_bytes()).unwrap_err();
        assert!(e.starts_with(&format!("a.obj, line {line}: OBJ")), "{e}");
    }
}

proptest::proptest! {
    #[test]
    fn no_bytes_make_the_readers_panic(bytes in proptest::collection::vec(proptest::prelude::any::<u8>(), 0..60), cut in 0_usize..1400) {
        for name in ["a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"] {
            let _ = read_as(name, &bytes);
        }
        let _ = read_as("a.glb", &[b"glTF\x02\0\0\0", bytes.as_slice()].concat());
        let mut damaged = gltf(|t| t);
        damaged.splice(cut.min(damaged.len())..(cut + 2).min(damaged.len()), bytes.iter().take(2).copied());
        let _ = read_as("a.gltf", &damaged);
    }
}

#[test]
fn positions_without_an_accessor_are_refused() {
    let damaged = gltf(|t| t.replace("\"POSITION\": 0", "\"POSITION\": 7"));
    let e = read_as("a.gltf", &damaged).unwrap_err();
    assert!(e.contains("accessor 7"), "{e}");
}

#[test]
fn files_of_other_endings_are_refused() {
    for name in ["a.rtm", "a.oct", "a.3ds", "a"] {
        let e = read_from(Path::new(name), b"").unwrap_err().to_string();
        assert!(e.contains(".obj .ply .stl"), "{e}");
    }
}
