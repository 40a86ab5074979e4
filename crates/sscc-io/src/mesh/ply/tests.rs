use super::*;

/// A square as one polygon, with properties and elements that are skipped.
fn header(format: &str, vertices: usize) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment caf\u{e9}\nobj_info x\nelement camera 1\nproperty float f\n\
         property list uchar short s\nelement vertex {vertices}\nproperty uchar red\nproperty double x\nproperty float y\n\
         property int z\nelement face 1\nproperty float quality\nproperty list uchar int vertex_indices\nend_header\n"
    )
}

fn text() -> String {
    format!("{}1.5\n2 7 8\n9 0 0 0\n9 1 0 0\n9 1 1.5 0\n9 0 1 -2\n0.5 4 0 1 2 3\n", header("ascii", 4))
}

/// The same mesh in binary.
fn binary(big: bool) -> Vec<u8> {
    let mut bytes = header(if big { "binary_big_endian" } else { "binary_little_endian" }, 4).into_bytes();
    let mut put = |little: &[u8]| {
        if big {
            bytes.extend(little.iter().rev());
        } else {
            bytes.extend(little);
        }
    };
    put(&1.5f32.to_le_bytes());
    put(&[2]);
    put(&7i16.to_le_bytes());
    put(&8i16.to_le_bytes());
    for (x, y, z) in [(0.0f64, 0.0f32, 0i32), (1.0, 0.0, 0), (1.0, 1.5, 0), (0.0, 1.0, -2)] {
        put(&[9]);
        put(&x.to_le_bytes());
        put(&y.to_le_bytes());
        put(&z.to_le_bytes());
    }
    put(&0.5f32.to_le_bytes());
    put(&[4]);
    for corner in 0..4i32 {
        put(&corner.to_le_bytes());
    }
    bytes
}

fn message(bytes: &[u8]) -> String {
    parse(bytes).unwrap_err().to_string()
}

#[test]
fn all_encodings_give_the_same_mesh() {
    let mesh = parse(text().as_bytes()).unwrap();
    assert_eq!(mesh.faces(), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(mesh.rest_positions()[2], DVec3::new(1.0, 1.5, 0.0));
    assert_eq!(mesh.rest_positions()[3], DVec3::new(0.0, 1.0, -2.0));
    assert_eq!(parse(&binary(false)).unwrap(), mesh);
    assert_eq!(parse(&binary(true)).unwrap(), mesh);
    assert_eq!(parse(text().replace('\n', "\r\n").as_bytes()).unwrap(), mesh);
    let crlf = header("binary_little_endian", 4);
    let body = binary(false)[crlf.len()..].to_vec();
    assert_eq!(parse(&[crlf.replace('\n', "\r\n").as_bytes(), &body].concat()).unwrap(), mesh);
    assert_eq!(parse(text().replace("vertex_indices", "vertex_index").as_bytes()).unwrap(), mesh);
}

#[test]
fn text_numbers_have_the_declared_type() {
    let text = text().replace("9 1 1.5 0", "9 0.1 0.1 0");
    let position = parse(text.as_bytes()).unwrap().rest_positions()[2];
    assert_eq!(position, DVec3::new(0.1, f64::from(0.1f32), 0.0));
}

#[test]
fn truncations_and_extra_bytes_are_rejected() {
    for bytes in [binary(false), binary(true)] {
        for len in 0..bytes.len() {
            assert!(parse(&bytes[..len]).is_err(), "{len}");
        }
        assert!(message(&[&bytes[..], b"\n"].concat()).contains("1 bytes more than the header declares"));
    }
    let text = text();
    for len in 0..text.len() - 2 {
        assert!(parse(&text.as_bytes()[..len]).is_err(), "{len}");
    }
    assert_eq!(
        message(format!("{text}7").as_bytes()),
        "line 24: the file has 1 bytes more than the header declares"
    );
}

#[test]
fn hostile_counts_are_rejected() {
    for count in ["5", "4294967296", "18446744073709551615", "99999999999999999999999"] {
        for bytes in [text().into_bytes(), binary(false)] {
            let from = b"element vertex 4";
            let at = bytes.windows(from.len()).position(|w| w == from).unwrap();
            let to = format!("element vertex {count}");
            let bytes = [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat();
            assert!(parse(&bytes).is_err(), "{count}");
        }
    }
    let empty_rows = text().replace("element camera", "element nothing 18446744073709551615\nelement camera");
    assert_eq!(parse(empty_rows.as_bytes()).unwrap().faces().len(), 2);
    let long_list = text().replace("2 7 8", "255 7 8");
    assert!(message(long_list.as_bytes()).contains("a list of 255 items does not fit into the file"));
}

#[test]
fn errors_in_headers_name_the_line() {
    let with = |from: &str, to: &str| message(text().replace(from, to).as_bytes());
    assert_eq!(with("ply\n", "PLY\n"), "line 1: a PLY file begins with 'ply'");
    assert_eq!(with("ascii 1.0", "ascii 1.1"), "line 2: not a line of a PLY header: 'format ascii 1.1'");
    assert_eq!(with("ascii", "asci"), "line 2: unknown format 'asci'");
    assert_eq!(with("format ascii 1.0\n", ""), "line 15: the header has no line 'format'");
    assert_eq!(with("property float f", "property half f"), "line 6: unknown type 'half'");
    assert_eq!(
        with("list uchar short", "list float short"),
        "line 7: the length of a list must be of an integer type"
    );
    assert_eq!(with("int z", "int w"), "line 8: the element 'vertex' has no scalar property 'z'");
    assert_eq!(with("int z", "int x"), "line 12: a second property 'x'");
    assert_eq!(with("element camera", "element vertex"), "line 8: a second element 'vertex'");
    assert_eq!(
        with("vertex_indices", "corners"),
        "line 13: the element 'face' has no list 'vertex_indices' or 'vertex_index'"
    );
    assert_eq!(with("element camera 1\n", ""), "line 5: a property before the first element");
    assert_eq!(with("element face 1", "element face -1"), "line 13: '-1' is not a count");
    assert_eq!(message(b"ply\n"), "the file ends within the header");
    let many =
        |line: &dyn Fn(usize) -> String| text().replace("comment", &(0..300).map(line).collect::<String>());
    let elements = many(&|i| format!("element e{i} 0\n"));
    assert_eq!(message(elements.as_bytes()), "line 259: more than 256 elements");
    let properties = many(&|i| if i == 0 { "element e 0\n".into() } else { format!("property int p{i}\n") });
    assert_eq!(message(properties.as_bytes()), "line 260: more than 256 properties");
}

#[test]
fn errors_in_rows_name_the_place() {
    let with = |from: &str, to: &str| message(text().replace(from, to).as_bytes());
    assert_eq!(with("4 0 1 2 3", "4 0 1 2 4"), "line 23: names vertex 4 (counted from 0), but there are 4");
    assert_eq!(with("4 0 1 2 3", "4 0 1 2 -1"), "line 23: -1 is negative");
    assert_eq!(with("4 0 1 2 3", "2 0 1"), "line 23: a face needs at least 3 corners, this one has 2");
    assert_eq!(with("9 1 0 0", "9 1 0 0.5"), "line 20: '0.5' is not a number of the declared type");
    assert_eq!(with("9 1 0 0", "256 1 0 0"), "line 20: '256' is not a number of the declared type");
    for bad in ["nan", "inf", "1e999"] {
        assert!(with("9 1 0 0", &format!("9 {bad} 0 0")).starts_with("vertex 1 (counted from 0)"), "{bad}");
    }
    assert!(
        with("uchar int vertex", "uchar float vertex").contains("vertex numbers must be of an integer type")
    );
}
