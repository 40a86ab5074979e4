//! Random bytes and damaged files for every parser: each returns a result or an error, and never panics.

use std::io::Write;

use proptest::prelude::*;
use sscc_io::container::{CERTIFICATES, Container, MODEL, certificates_from_bytes, model_from_bytes};
use sscc_io::mesh::{obj, off, ply, stl};
use sscc_io::modes::{array, vega};
use sscc_io::{gltf, npy, npz};

fn parse_all(bytes: &[u8]) {
    for mesh in [obj::parse(bytes), off::parse(bytes), ply::parse(bytes), stl::parse(bytes)] {
        one_line(&mesh);
    }
    for vertices in [0, 1, 3] {
        for precision in [vega::Precision::Single, vega::Precision::Double] {
            one_line(&vega::parse(bytes, precision, vertices));
        }
        match npy::parse(bytes) {
            Ok(read) => one_line(&array::from_array(&read, vertices)),
            Err(error) => one_line(&Err::<(), _>(error)),
        }
    }
    one_line(&npy::parse_integers(bytes));
    one_line(&npz::parse_model(bytes));
    one_line(&gltf::parse(bytes, None));
    one_line(&gltf::parse(bytes, Some("#0")));
    one_line(&gltf::parse_scene(bytes));
    one_line(&gltf::parse_placed_mesh(bytes, None));
    one_line(&gltf::parse_contents(bytes));
    one_line(&model_from_bytes(bytes));
    one_line(&certificates_from_bytes(bytes));
    for kind in [MODEL, CERTIFICATES] {
        one_line(&Container::parse(bytes, kind));
    }
}

fn one_line<T>(result: &Result<T, sscc_io::FormatError>) {
    if let Err(error) = result {
        let message = error.to_string();
        assert!(!message.is_empty() && !message.contains('\n') && message.len() < 400, "{message}");
    }
}

/// Small valid files. Damaged copies reach deeper into a parser than random bytes.
fn seeds() -> Vec<Vec<u8>> {
    let ply = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_index\nend_header\n";
    let text = format!("ply\nformat ascii 1.0\n{ply}0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let mut binary = format!("ply\nformat binary_little_endian 1.0\n{ply}").into_bytes();
    binary.extend([0; 36]);
    binary.extend([3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    vec![
        b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2/2 \\\n -1\n".to_vec(),
        b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec(),
        text.into_bytes(),
        binary,
        npy::to_bytes(&[9, 2], &[0.5; 18]).unwrap(),
        npy::to_bytes(&[3, 3, 3], &[0.5; 27]).unwrap(),
        [&[9, 0, 0, 0, 2, 0, 0, 0][..], &[0; 72]].concat(),
        b"solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"
            .to_vec(),
        [&[0; 80][..], &[1, 0, 0, 0], &[0; 50]].concat(),
        GLTF.as_bytes().to_vec(),
        npz(zip::CompressionMethod::Stored),
        npz(zip::CompressionMethod::Deflated),
        CONCAVE.to_vec(),
        CONCAVE.iter().map(|byte| if *byte == b'\n' { b'\r' } else { *byte }).collect(),
        strips(false),
        strips(true),
        [&[b'x'; 80][..], &[1, 0, 0, 0], &[0; 48], &[3, 0], b"abc"].concat(),
        [&[b'x'; 80][..], &[0; 4], &[0; 50]].concat(),
        npy::to_bytes(&[3, 3], &[0.5; 9]).unwrap(),
        half_floats(),
    ]
}

/// Concave, bent and crossing polygons, some with repeated corners.
const CONCAVE: &[u8] =
    b"v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nv 2 2 5\nfo 1 2 3 4 5\nf 1 3 2 5\nf 1 2 2 3 6 4 4\n\
    f 2 3 4 5 1 2 6 3\n";

/// Strips of triangles as text or in binary.
fn strips(is_binary: bool) -> Vec<u8> {
    let header = "element vertex 4\nproperty char x\nproperty char y\nproperty char z\nelement tristrips 1\n\
        property list uchar char vertex_index\nend_header\n";
    if is_binary {
        let bytes = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 6, 0, 1, 2, 3, 255, 0];
        return [b"ply\nformat binary_big_endian 1.0\n", header.as_bytes(), &bytes].concat();
    }
    format!("ply\nformat ascii 1.0\n{header}0 0 0\n1 0 0\n0 1 0\n0 0 1\n6 0 1 2 3 -1 0\n").into_bytes()
}

fn half_floats() -> Vec<u8> {
    let mut bytes = npy::to_bytes(&[3, 3], &[0.0; 9]).unwrap();
    let descr = bytes.windows(3).position(|w| w == b"<f8").unwrap();
    bytes[descr..descr + 3].copy_from_slice(b"<f2");
    bytes.truncate(bytes.len() - 54);
    bytes
}

/// A triangle with a plain and a sparse target.
const GLTF: &str = r#"{"asset":{"version":"2.0"},
"buffers":[{"byteLength":60,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAQAAAAAAAAAAAAAAAACAPwAAAQIAAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":16},{"buffer":0,"byteOffset":52,"byteLength":4}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
{"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":1,"componentType":5125},
"values":{"bufferView":1,"byteOffset":4}}},{"bufferView":2,"byteOffset":1,"componentType":5121,"count":3,"type":"SCALAR"}],
"meshes":[{"name":"a","primitives":[{"attributes":{"POSITION":0},"indices":2,"targets":[{"POSITION":0},{"POSITION":1}]}]}]}"#;

fn npz(method: zip::CompressionMethod) -> Vec<u8> {
    let mut writer = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(method);
    let mut faces = npy::to_bytes(&[1, 3], &[0.0; 3]).unwrap();
    let descr = faces.windows(3).position(|w| w == b"<f8").unwrap();
    faces[descr..descr + 3].copy_from_slice(b"<i8");
    let arrays = [("mean", npy::to_bytes(&[3, 3], &[0.5; 9]).unwrap()), ("faces", faces)];
    for (name, array) in arrays.into_iter().chain([("U", npy::to_bytes(&[9, 2], &[0.5; 18]).unwrap())]) {
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(&array).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

#[test]
fn seeds_are_valid() {
    let seeds = seeds();
    assert!(obj::parse(&seeds[0]).is_ok() && off::parse(&seeds[1]).is_ok());
    assert!(ply::parse(&seeds[2]).is_ok() && ply::parse(&seeds[3]).is_ok());
    assert!(npy::parse(&seeds[4]).is_ok() && npy::parse(&seeds[5]).is_ok());
    assert!(vega::parse(&seeds[6], vega::Precision::Single, 3).is_ok());
    assert!(stl::parse(&seeds[7]).is_ok() && stl::parse(&seeds[8]).is_ok());
    assert_eq!(gltf::parse(&seeds[9], None).unwrap().modes.rank(), 2);
    assert!(npz::parse_model(&seeds[10]).is_ok() && npz::parse_model(&seeds[11]).is_ok());
    assert_eq!(obj::parse(&seeds[12]).unwrap(), obj::parse(&seeds[13]).unwrap());
    assert_eq!(ply::parse(&seeds[14]).unwrap(), ply::parse(&seeds[15]).unwrap());
    assert!(stl::parse(&seeds[16]).is_ok() && stl::parse(&seeds[17]).is_ok());
    assert!(npy::parse(&seeds[18]).is_ok() && npy::parse(&seeds[19]).is_ok());
}

/// A valid glTF file with exchanged numbers, which is still valid JSON.
fn swapped_gltf() -> impl Strategy<Value = String> {
    let numbers = prop::sample::select(vec![
        "0",
        "1",
        "2",
        "3",
        "4",
        "35",
        "36",
        "60",
        "5121",
        "5126",
        "18446744073709551615",
    ]);
    prop::collection::vec((any::<prop::sample::Index>(), numbers), 1..5).prop_map(|changes| {
        // Words of digits alternate with the text between them.
        let mut words: Vec<String> = Vec::new();
        for c in GLTF.chars() {
            match words.last_mut() {
                Some(last) if last.ends_with(|l: char| l.is_ascii_digit()) == c.is_ascii_digit() => {
                    last.push(c)
                }
                _ => words.push(c.into()),
            }
        }
        for (at, number) in changes {
            let digits: Vec<_> =
                (0..words.len()).filter(|i| words[*i].starts_with(|c: char| c.is_ascii_digit())).collect();
            words[digits[at.index(digits.len())]] = number.into();
        }
        words.concat()
    })
}

/// The corners of random polygons: a few points of a small grid, so that corners repeat, lie on edges and edges cross.
fn random_polygon() -> impl Strategy<Value = Vec<[i8; 3]>> {
    prop::collection::vec(prop::array::uniform3(0_i8..4), 4..12)
}

proptest! {
    /// Every polygon of n corners becomes n - 2 triangles, which have its corners and its border.
    #[test]
    fn random_polygons(polygon in random_polygon(), is_flat: bool, scale in prop::sample::select(vec![1.0, 1e-300, 1e59])) {
        let mut text = String::new();
        for [x, y, z] in &polygon {
            let [x, y, z] = [*x, *y, if is_flat { 0 } else { *z }].map(|number| f64::from(number) * scale);
            text += &format!("v {x:e} {y:e} {z:e}\n");
        }
        let corners: Vec<String> = (1..=polygon.len()).map(|corner| corner.to_string()).collect();
        text += &format!("f {}\n", corners.join(" "));
        let mesh = obj::parse(text.as_bytes()).unwrap();
        prop_assert_eq!(mesh.faces().len(), polygon.len() - 2);
        let mut edges: Vec<[u32; 2]> =
            mesh.faces().iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]).collect();
        let inner: Vec<[u32; 2]> = edges.iter().copied().filter(|[a, b]| edges.contains(&[*b, *a])).collect();
        edges.retain(|edge| !inner.contains(edge));
        edges.sort_unstable();
        let count = polygon.len() as u32;
        let mut border: Vec<[u32; 2]> = (0..count).map(|corner| [corner, (corner + 1) % count]).collect();
        border.sort_unstable();
        prop_assert_eq!(edges, border);
    }

    #[test]
    fn exchanged_numbers(text in swapped_gltf()) {
        one_line(&gltf::parse(text.as_bytes(), None));
        one_line(&gltf::parse_scene(text.as_bytes()));
        one_line(&gltf::parse_placed_mesh(text.as_bytes(), None));
        one_line(&gltf::parse_contents(text.as_bytes()));
    }

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        parse_all(&bytes);
    }

    #[test]
    fn random_words(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "v", "f", "F", "fo", "surf", "OFF", "OFF3", "tristrips", "ply", "format", "ascii", "1.0", "element", "vertex", "face", "property", "list",
                "float", "int", "uchar", "x", "y", "z", "vertex_index", "end_header", "0", "1", "2", "3", "-1", "1/2",
                "18446744073709551615", "1e999", "solid", "facet", "outer", "endloop", "endfacet", "endsolid", "nan", "\\", "#", "loop",
                "\n", "\n", "\n", "\r\n", "\r", "\u{a0}", "\u{feff}", "\u{e9}",
            ]),
            0..80,
        ),
        joint in prop::sample::select(vec![" ", "\n", ""]),
    ) {
        parse_all(words.join(joint).as_bytes());
    }

    #[test]
    fn damaged_files(
        seed in 0_usize..20,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        cut in any::<prop::sample::Index>(),
        whole: bool,
    ) {
        let mut bytes = seeds().swap_remove(seed);
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let len = if whole { bytes.len() } else { cut.index(bytes.len()) };
        parse_all(&bytes[..len]);
    }
}
