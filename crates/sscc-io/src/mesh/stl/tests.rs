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

/// A facet of the corners of `TEXT`'s second one.
const FACET: &str =
    "facet normal 0 0 1 outer loop vertex 1 0 0 vertex 0 0 -2 vertex 0 1.5 0 endloop endfacet";

#[test]
fn text_is_a_sequence_of_words() {
    let mesh = parse(TEXT.as_bytes()).unwrap();
    let (first, rest) = TEXT.split_at("solid a name\n".len());
    let before_second = TEXT.split(" facet normal 0 0 1").next().unwrap();
    for text in [
        // Both facets, or all, in one line; each word in a line.
        TEXT.replace("endfacet\n\n", "endfacet "),
        TEXT.replace('\n', " "),
        format!("{first}{}", rest.replace('\n', " ")),
        format!("{first}{}", rest.replace(' ', "\n")),
        TEXT.replace("\n  outer loop\n", " outer loop "),
        format!("{before_second}{FACET}\nendsolid x\n"),
        format!("{} {FACET} endsolid x", before_second.trim_end()),
        // Several kinds of line ends.
        TEXT.replace('\n', "\r") + "\n",
        TEXT.replacen('\n', "\r", 3),
        TEXT.replace('\n', "\r\r\n"),
        // Names with keywords, and further words beside a normal.
        TEXT.replace("a name", "facet normal 0 0 1 my endsolid"),
        format!("{TEXT} solid facet\n"),
        TEXT.replace("0 0 nan", "0 0 nan color 1"),
        TEXT.replace(" normal 0 0 nan", ""),
        TEXT.replace(" normal 0 0 nan", "\nnormal 0 0 -inf"),
    ] {
        assert_eq!(parse(text.as_bytes()).unwrap(), mesh, "{text}");
    }
}

#[test]
fn every_solid_of_a_text_is_read() {
    let solid = |name: &str| format!("solid {name}\n{FACET}\nendsolid {name}\n");
    let (a, b) = (solid("a"), solid("b"));
    for text in [
        format!("{a}{b}"),
        format!("{a}{}", b.replace('\n', "\r")),
        format!("{}{b}", a.replace('\n', "\r")),
        format!("{}{b}", a.replace("endsolid a\n", "endsolid a\r")),
        format!("{a}\u{feff}{b}"),
        format!("{a}{b}").replace('\n', " "),
        format!("{a}{b}").replace('\n', " ").replace("endsolid a", "endsolid"),
    ] {
        assert_eq!(parse(text.as_bytes()).unwrap().faces(), [[0, 1, 2], [3, 4, 5]], "{text}");
    }
    // A line of many solids, in linear time.
    let many = solid("a").replace('\n', " ").repeat(3000);
    assert_eq!(parse(many.as_bytes()).unwrap().faces().len(), 3000);
}

#[test]
fn wrong_words_of_a_text_are_refused_with_their_line() {
    let with = |from: &str, to: &str| message(TEXT.replacen(from, to, 1));
    assert_eq!(with("endfacet", "endfacet x"), "line 8: 'facet' or 'endsolid' expected, not 'x'");
    assert_eq!(with("endloop", "endloop x"), "line 7: 'endfacet' expected, not 'x'");
    assert_eq!(with("outer loop", "outer"), "line 4: 'outer loop' expected, not 'vertex'");
    assert_eq!(with("  outer loop\n", ""), "line 3: 'outer loop' expected, not 'vertex'");
    assert_eq!(with("nan\n  outer loop\n", "nan"), "line 2: 'outer loop' expected, not 'vertex'");
    assert_eq!(with("vertex 1 0 0", "vertex 1 x 0"), "line 5: 'x' is not a number");
    assert_eq!(with("\n   vertex 1 0 0", "\r   vertex 1 x 0"), "line 5: 'x' is not a number");
    assert_eq!(with("vertex 1 0 0\n", "vertex 1 0 \n"), "line 5: a vertex has 3 coordinates");
    assert_eq!(with("vertex 0 1.5e0 0", "vertex 0 1.5e0 0 0"), "line 6: a vertex has 3 coordinates");
    assert_eq!(message("solid x\nfacet outer loop vertex 1 2"), "line 2: a vertex has 3 coordinates");
    // A damaged facet is no part of a name.
    for (from, to) in [("outer", "inner"), ("loop", "lop"), ("vertex", "vertx"), ("endloop", "end loop")] {
        let line = format!("solid x {FACET} {FACET} endsolid x").replacen(from, to, 1);
        assert!(message(&line).starts_with("line 1: '"), "{line}");
    }
    // A facet in the line of `endsolid` belongs to no solid.
    assert_eq!(message(format!("{TEXT} a {FACET}")), "line 17: 'solid' expected, not 'facet'");
    assert_eq!(
        message("solid x facet normal 0 0 1\nouter"),
        "line 2: 'facet' or 'endsolid' expected, not 'outer'"
    );
}

#[test]
fn texts_that_are_no_text_stl_are_not_called_cut_off() {
    let remove = "text STL begins with 'solid': remove the lines before this one";
    for start in ["# made by x\n", "\u{feff}; made by x\r\n", "made by caf\u{e9}\r"] {
        assert_eq!(message(format!("{start}{TEXT}")), format!("line 2: {remove}"));
    }
    let begin = "text STL begins with 'solid': begin the file with a line 'solid', then this line";
    let (_, facets) = TEXT.split_at("solid a name\n".len());
    assert_eq!(message(facets), format!("line 1: {begin}"));
    assert_eq!(message(format!("# a\n\n{facets}\n{TEXT}")), format!("line 3: {begin}"));
    assert_eq!(message(TEXT.replacen("solid", "sold", 1)), format!("line 2: {begin}"));
    for bytes in [u16::to_le_bytes, u16::to_be_bytes] {
        let utf16: Vec<u8> = format!("\u{feff}{TEXT}").encode_utf16().flat_map(bytes).collect();
        assert_eq!(message(&utf16), "the file is UTF-16 text: save it as UTF-8");
    }
    let zero = "the text has a zero byte: remove it";
    assert_eq!(message(TEXT.replacen("a name", "a\0name", 1)), format!("line 1: {zero}"));
    assert_eq!(message(TEXT.replacen("vertex 0 0 0", "vertex 0\0 0", 1)), format!("line 4: {zero}"));
    let obj = "v 0 0 0\n".repeat(20);
    assert_eq!(message(obj), "line 1: not an STL file: text STL begins with 'solid', not 'v'");
    // Binary files of the same beginnings are.
    for header in [&b"x"[..], b"solid", b"facet normal", b"# a\nsolid b\n"] {
        let bytes = binary_file(header, [0, 0]);
        assert!(message(&bytes[..bytes.len() - 1]).ends_with("is the file cut off?"));
    }
}
