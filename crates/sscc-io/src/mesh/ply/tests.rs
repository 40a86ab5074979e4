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
    assert_eq!(with("int z", "int x"), "line 12: there is a second property 'x'");
    assert_eq!(with("element camera", "element vertex"), "line 8: there is a second element 'vertex'");
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
    assert_eq!(
        with("4 0 1 2 3", "4 0 1 2 4"),
        "line 23: the face names vertex 4 (counted from 0), but there are 4"
    );
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

const SIX: &str = "0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n2 1 1\n";

/// A text file of six vertices and one further element.
fn with_element(element: &str, rows: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n\
         {element}\nend_header\n{SIX}{rows}"
    )
}

fn strips(types: &str, rows: &str) -> Result<Vec<[u32; 3]>, String> {
    let element = format!("element tristrips 1\nproperty list {types} vertex_indices");
    match parse(with_element(&element, rows).as_bytes()) {
        Ok(mesh) => Ok(mesh.faces().to_vec()),
        Err(error) => Err(error.to_string()),
    }
}

#[test]
fn strips_are_faces() {
    let all = [[0, 1, 2], [2, 1, 3], [3, 4, 5]];
    for types in ["int int", "uchar int", "uchar char", "short short", "uint int"] {
        assert_eq!(strips(types, "8 0 1 2 3 -1 3 4 5\n").unwrap(), all, "{types}");
    }
    for (types, end) in [("uchar uchar", "255"), ("int ushort", "65535"), ("int uint", "4294967295")] {
        let rows = format!("9 0 1 2 3 {end} 3 4 5 {end}\n");
        assert_eq!(strips(types, &rows).unwrap(), all, "{types}");
    }
    // Repeated corners connect strips; a strip of two corners has no triangle.
    assert_eq!(strips("int int", "10 0 1 2 2 3 3 4 5 -1 1\n").unwrap(), [[0, 1, 2], [4, 3, 5]]);
    let faces = "element face 1\nproperty list uchar int vertex_indices\nelement tristrips 1\n\
        property list int int vertex_indices";
    let mesh = parse(with_element(faces, "3 0 1 2\n4 3 4 5 -1\n").as_bytes()).unwrap();
    assert_eq!(mesh.faces(), [[0, 1, 2], [3, 4, 5]]);

    assert_eq!(strips("int int", "3 0 1 -2\n").unwrap_err(), "line 16: -2 is neither a vertex nor -1");
    assert_eq!(
        strips("int int", "3 0 1 6\n").unwrap_err(),
        "line 16: the face names vertex 6 (counted from 0), but there are 6"
    );
    assert!(strips("int float", "3 0 1 2\n").unwrap_err().contains("of an integer type"));
    assert!(strips("int int", "3 0 1\n").is_err());
}

#[test]
fn binary_strips_are_faces() {
    for big in [false, true] {
        let format = if big { "binary_big_endian" } else { "binary_little_endian" };
        let header = format!(
            "ply\nformat {format} 1.0\nelement vertex 6\nproperty char x\nproperty char y\nproperty char z\n\
             element tristrips 2\nproperty list ushort int vertex_index\nend_header\n"
        );
        let mut bytes = header.into_bytes();
        bytes.extend([0, 0, 0, 4, 0, 0, 0, 4, 0, 1, 1, 255, 1, 1, 1, 2, 1, 1]);
        for strip in [&[0, 1, 2, -1, 1, 3, 2, 4][..], &[3, 4, 5]] {
            let count = strip.len() as u16;
            bytes.extend(if big { count.to_be_bytes() } else { count.to_le_bytes() });
            strip
                .iter()
                .for_each(|c: &i32| bytes.extend(if big { c.to_be_bytes() } else { c.to_le_bytes() }));
        }
        let faces = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 4, 5]];
        assert_eq!(parse(&bytes).unwrap().faces(), faces);
        (0..bytes.len()).for_each(|len| assert!(parse(&bytes[..len]).is_err(), "{len}"));
    }
}

#[test]
fn elements_with_unknown_faces_are_refused() {
    let message = |element: &str, rows: &str| {
        parse(
            with_element(&format!("{element}\nelement face 1\nproperty list uchar int vertex_indices"), rows)
                .as_bytes(),
        )
        .map(|mesh| mesh.faces().len())
        .map_err(|error| error.to_string())
    };
    for name in ["vertex_indices", "vertices", "indices", "vert_idx"] {
        let element = format!("element patch 1\nproperty list uchar int {name}");
        let refused = message(&element, "3 3 4 5\n3 0 1 2\n").unwrap_err();
        assert!(
            refused.starts_with("line 7: the element 'patch' has lists of vertex numbers, as faces have"),
            "{refused}"
        );
    }
    let grid = "element range_grid 1\nproperty list uchar int vertex_indices";
    assert!(message(grid, "1 3\n3 0 1 2\n").unwrap_err().contains("'range_grid'"));
    assert_eq!(message("element patch 0\nproperty list uchar int vertex_indices", "3 0 1 2\n"), Ok(1));
    // Elements of lines, and lists of numbers of other kinds, are skipped.
    assert_eq!(message("element edge 1\nproperty list uchar int vertex_indices", "2 3 4\n3 0 1 2\n"), Ok(1));
    assert_eq!(
        message("element edge 1\nproperty int vertex1\nproperty int vertex2", "3 4\n3 0 1 2\n"),
        Ok(1)
    );
    assert_eq!(message("element a 1\nproperty list uchar float vertex_weights", "2 .5 .5\n3 0 1 2\n"), Ok(1));
    let texture = "element multi_texture_face 1\nproperty list uchar int texture_vertex_indices";
    assert_eq!(message(texture, "3 7 8 9\n3 0 1 2\n"), Ok(1));
    let two = "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar int vertex_index";
    let refused = parse(with_element(two, "3 0 1 2 3 3 4 5\n").as_bytes()).unwrap_err().to_string();
    assert_eq!(refused, "line 7: the element 'face' has two lists of corners: remove one of them");
}

#[test]
fn rows_of_another_length_name_their_line() {
    let faces = "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red";
    let message = |rows: &str| parse(with_element(faces, rows).as_bytes()).unwrap_err().to_string();
    let more = "this row has more values than the header declares";
    assert_eq!(message("3 0 1 2 3 255 0 0\n3 3 4 5 3 255 0 0\n"), format!("line 17: {more}"));
    // Read as rows, the numbers left over begin with a face of one corner.
    assert_eq!(message("3 0 1 2 3 1 0 0\n3 3 4 5 3 1 0 0\n"), format!("line 17: {more}"));
    assert_eq!(message("3 0 1 2 3\n3 3 4 5 3 9\n"), format!("line 18: {more}"));
    assert_eq!(message("3 0 1 2\n3 3 4 5\n"), "line 17: this row has fewer values than the header declares");
    // Rows in one line, and over several ones, are read if the count of all numbers fits.
    let rows = "3 0 1 2 3 3 3 4\n5 3\n";
    assert_eq!(parse(with_element(faces, rows).as_bytes()).unwrap().faces(), [[0, 1, 2], [3, 4, 5]]);
}

#[test]
fn lines_may_end_with_cr_alone() {
    let mesh = parse(text().as_bytes()).unwrap();
    assert_eq!(parse(text().replace('\n', "\r").as_bytes()).unwrap(), mesh);
    let wrong = text().replace("4 0 1 2 3", "4 0 1 2 4").replace('\n', "\r");
    assert_eq!(
        message(wrong.as_bytes()),
        "line 23: the face names vertex 4 (counted from 0), but there are 4"
    );
    for big in [false, true] {
        let lf = header(if big { "binary_big_endian" } else { "binary_little_endian" }, 4);
        let body = binary(big)[lf.len()..].to_vec();
        assert_eq!(parse(&[lf.replace('\n', "\r").as_bytes(), &body].concat()).unwrap(), mesh);
    }
}

#[test]
fn errors_name_their_own_line_after_rows_over_several_lines() {
    let faces = "element face 2\nproperty list uchar int vertex_indices\nproperty uchar red";
    // Line 11 goes on in line 12, which is valid. The faces are in lines 18 and 19.
    let valid = with_element(faces, "3 0 1 2 9\n3 3 4 5 9\n").replacen("0 0 0", "0\n0 0", 1);
    assert_eq!(parse(valid.as_bytes()).unwrap().faces(), [[0, 1, 2], [3, 4, 5]]);
    let with = |from: &str, to: &str| message(valid.replacen(from, to, 1).as_bytes());
    assert_eq!(with("3 3 4 5", "3 3 4 x"), "line 19: 'x' is not a number of the declared type");
    assert_eq!(with("3 3 4 5 9", "3 3 4 5 256"), "line 19: '256' is not a number of the declared type");
    assert_eq!(with("3 3 4 5", "3 3 4 -5"), "line 19: -5 is negative");
    assert_eq!(with("3 3 4 5", "2 3 4"), "line 19: a face needs at least 3 corners, this one has 2");
    assert_eq!(with("3 3 4 5", "250 3 4 5"), "line 19: a list of 250 items does not fit into the file");
    assert_eq!(with("2 1 1", "2 1 nan1"), "line 17: 'nan1' is not a number of the declared type");
    assert_eq!(
        with("3 3 4 5", "3 3 4 6"),
        "line 19: the face names vertex 6 (counted from 0), but there are 6"
    );
    let other = "line 7: the element 'face' has no list 'vertex_indices' or 'vertex_index'";
    assert_eq!(with("vertex_indices", "corners"), other);
    // Numbers that are missing or left over can belong to any uneven row.
    let fewer = "line 11: this row has fewer values than the header declares";
    for (from, to) in [("3 3 4 5 9\n", "3 3 4 5"), ("3 3 4 5 9", "3 3 4 5 9 9"), ("face 2", "face 200")] {
        assert_eq!(with(from, to), fewer);
    }
    // A count in the middle of a line may be another number.
    assert_eq!(with("3 0 1 2 9\n3 3 4 5", "3 0 1 2 9 250 3 4 5"), fewer);
}

#[test]
fn a_single_cr_ends_a_line_of_a_file_with_other_line_ends() {
    let mesh = parse(text().as_bytes()).unwrap();
    for (from, to) in [
        ("obj_info x\n", "obj_info x\r"),
        ("comment caf\u{e9}\n", "comment caf\u{e9}\r"),
        ("end_header\n", "end_header\r"),
        ("end_header\n", "end_header\r\n"),
        ("9 1 0 0\n", "9 1 0 0\r"),
        ("ply\n", "ply\r"),
        ("ply\n", "ply\r\n"),
    ] {
        let mixed = text().replacen(from, to, 1);
        assert_eq!(parse(mixed.as_bytes()).unwrap(), mesh, "{to:?}");
        let wrong = mixed.replace("4 0 1 2 3", "4 0 1 2 x");
        assert_eq!(message(wrong.as_bytes()), "line 23: 'x' is not a number of the declared type", "{to:?}");
    }
    // Text mode that wrote CR LF as CR CR LF.
    assert_eq!(parse(text().replace('\n', "\r\r\n").as_bytes()).unwrap(), mesh);
    // A comment hides no declaration.
    let hidden = text().replace("element face 1\n", "comment faces\relement face 1\n");
    assert_eq!(parse(hidden.as_bytes()).unwrap(), mesh);
}

#[test]
fn rows_of_binary_files_may_begin_with_bytes_of_line_ends() {
    let declarations = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty char x\nproperty char y\n\
        property char z\nelement face 1\nproperty list uchar uchar vertex_indices\nend_header\n";
    for end in ["\n", "\r\n", "\r"] {
        for first in [b'\n', b'\r', b' '] {
            let rows = [first, 0, 0, 1, 0, 0, 0, 1, 0, 3, 0, 1, 2];
            let bytes = [declarations.replace('\n', end).as_bytes(), &rows].concat();
            let mesh = parse(&bytes).unwrap();
            assert_eq!(mesh.rest_positions()[0], DVec3::new(first.into(), 0.0, 0.0), "{end:?} {first}");
        }
    }
}
