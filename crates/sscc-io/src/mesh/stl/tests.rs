use super::*;

const TEXT: &str = "solid a name\n facet normal 0 0 nan\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   \
    vertex 0 1.5e0 0\n  endloop\n endfacet\n\n facet normal 0 0 1\n  outer loop\n   vertex 1 0 0\n   \
    vertex 0 0 -2\n   vertex 0 1.5 0\n  endloop\n endfacet\nendsolid";

/// The same mesh in binary, with this header and these attribute bytes.
fn binary_file(header: &[u8], attribute: [u8; 2]) -> Vec<u8> {
    let mut bytes = header.to_vec();
    bytes.resize(80, b' ');
    bytes.extend(2u32.to_le_bytes());
    for corners in [
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.5, 0.0]],
        [[1.0, 0.0, 0.0], [0.0, 0.0, -2.0], [0.0, 1.5, 0.0]],
    ] {
        bytes.extend([0; 12]);
        bytes.extend(corners.as_flattened().iter().flat_map(|x: &f32| x.to_le_bytes()));
        bytes.extend(attribute);
    }
    bytes
}

fn message(bytes: impl AsRef<[u8]>) -> String {
    parse(bytes.as_ref()).unwrap_err().to_string()
}

#[test]
fn text_and_binary_give_the_same_mesh() {
    let mesh = parse(TEXT.as_bytes()).unwrap();
    assert_eq!(mesh.faces(), [[0, 1, 2], [3, 4, 5]]);
    assert_eq!(mesh.rest_positions()[1], mesh.rest_positions()[3], "equal vertices are not welded");
    assert_eq!(mesh.rest_positions()[4], DVec3::new(0.0, 0.0, -2.0));
    // The size decides, for any text in the header.
    for header in [&b""[..], b"solid", b"solid x\nfacet normal 0 0 0", b"\0\0"] {
        assert_eq!(parse(&binary_file(header, [0, 0])).unwrap(), mesh);
        assert_eq!(parse(&binary_file(header, [255, 1])).unwrap(), mesh);
    }
    assert_eq!(parse(TEXT.replace('\n', "\r").as_bytes()).unwrap(), mesh);
    assert_eq!(parse(TEXT.replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    assert_eq!(parse(TEXT.to_uppercase().as_bytes()).unwrap(), mesh);
    assert_eq!(parse(format!("\u{feff}\n{TEXT} a name\n\n").as_bytes()).unwrap(), mesh);
    let two = parse(format!("{TEXT}\n{TEXT}\n").as_bytes()).unwrap();
    assert_eq!(two.faces()[3], [9, 10, 11]);
    assert_eq!(parse(&[b"solid caf\xe9", &TEXT.as_bytes()[12..]].concat()).unwrap(), mesh);
}

#[test]
fn truncations_and_extra_bytes_are_rejected() {
    for header in [&b""[..], b"solid"] {
        let bytes = binary_file(header, [0, 0]);
        for len in 0..bytes.len() {
            assert!(parse(&bytes[..len]).is_err(), "{len}");
        }
        let extra = message([&bytes[..], &[0; 50]].concat());
        assert_eq!(
            extra,
            "byte 184: 50 bytes follow the 2 triangles that the header declares, which could be more triangles: correct the \
             count at byte 80, or remove these bytes"
        );
    }
    for len in 0..TEXT.len() {
        assert!(parse(&TEXT.as_bytes()[..len]).is_err(), "{len}");
    }
    assert_eq!(message(format!("{TEXT}\nx")), "line 18: 'solid' expected, not 'x'");
}

#[test]
fn binary_files_of_other_sizes() {
    let plain = binary_file(b"x", [0, 0]);
    let mesh = parse(&plain).unwrap();
    let read = |bytes: &[u8]| soup(bytes).unwrap().into_mesh_with_warnings().unwrap();
    for extra in [1, 17, 49] {
        let (found, warnings) = read(&[&plain[..], &vec![b'c'; extra]].concat());
        assert_eq!(found, mesh);
        assert_eq!(warnings, [format!("{extra} bytes after the last of the 2 triangles are skipped")]);
    }
    // Data of the length that the attribute bytes declare.
    let attributes = binary_file(b"x", [60, 0]);
    let payload = [1; 60];
    let payloads = [&attributes[..134], &payload, &attributes[134..], &payload].concat();
    assert_eq!(read(&payloads), (mesh.clone(), vec![]));
    assert!(parse(&payloads[..payloads.len() - 1]).is_err());
    // A count that was never set.
    let mut unset = plain.clone();
    unset[80..84].fill(0);
    let (found, warnings) = read(&unset);
    assert_eq!(found, mesh);
    assert!(warnings[0].contains("declares 0 triangles, but data of 2 follow"), "{warnings:?}");
    let cut = message(&unset[..unset.len() - 1]);
    assert!(
        cut.contains("declares 0 triangles (0 bytes), but 99 bytes follow: is the file cut off?"),
        "{cut}"
    );
}

#[test]
fn errors_name_the_place() {
    let with = |from: &str, to: &str| message(TEXT.replacen(from, to, 1));
    assert_eq!(with("vertex 1 0 0", "vertex 1 0"), "line 5: a vertex has 3 coordinates");
    assert_eq!(with("vertex 1 0 0", "vertex 1 0 0 0"), "line 5: a vertex has 3 coordinates");
    assert_eq!(with("vertex 1 0 0", "vertex 1 inf 0"), "line 5: 'inf' is not a finite number");
    assert_eq!(with("   vertex 1 0 0\n", ""), "line 6: 'vertex' (a facet has 3) expected, not 'endloop'");
    assert_eq!(
        with("vertex 1 0 0\n", "vertex 1 0 0\nvertex 1 0 0\n"),
        "line 7: 'endloop' (a facet has 3 vertices) expected, not 'vertex'"
    );
    assert_eq!(with("outer", "inner"), "line 3: 'outer loop' expected, not 'inner'");
    assert_eq!(with("\nendsolid", ""), "the file ends where 'facet' or 'endsolid' was expected");
    assert!(with("solid a", "sold a").starts_with("byte 80: the header declares "));
    assert!(message("sol").contains("not an STL file"));
    assert_eq!(message("solid x\nendsolid x\n"), "the mesh has no triangles");
    assert_eq!(message([0; 84]), "the mesh has no triangles");
    let mut huge = binary_file(b"", [0, 0]);
    huge[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(message(&huge).contains("4294967295 triangles (214748364750 bytes), but 100 bytes follow"));
    let mut nan = binary_file(b"", [0, 0]);
    nan[84 + 12..][..4].copy_from_slice(&f32::NAN.to_le_bytes());
    assert!(message(&nan).starts_with("vertex 0 (counted from 0)"));
}
