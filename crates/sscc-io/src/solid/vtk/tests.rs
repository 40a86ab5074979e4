use glam::DVec3;

use super::*;

/// A `.vtu` file with ASCII arrays.
fn vtu(points: &str, [connectivity, offsets, types]: [&str; 3], point_data: &str) -> String {
    let count = |text: &str| text.split_whitespace().count();
    let (n, cells) = (count(points) / 3, count(types));
    let array = |name: &str, kind: &str, text: &str| {
        format!("<DataArray type='{kind}' Name='{name}' format='ascii'>\n{text}\n</DataArray>\n")
    };
    let (connectivity, offsets) =
        (array("connectivity", "Int64", connectivity), array("offsets", "Int64", offsets));
    format!(
        "<?xml version='1.0'?>\n<VTKFile type='UnstructuredGrid' version='1.0' byte_order='LittleEndian'>\n\
         <UnstructuredGrid><Piece NumberOfPoints='{n}' NumberOfCells='{cells}'>\n\
         <PointData>{point_data}</PointData>\n<Cells>{connectivity}{offsets}{}</Cells>\n\
         <Points><DataArray type='Float64' NumberOfComponents='3' format='ascii'>{points}</DataArray></Points>\n\
         </Piece></UnstructuredGrid></VTKFile>",
        array("types", "UInt8", types)
    )
}

const TET: &str = "0 0 0 1 0 0 0 1 0 0 0 1";

fn refused(text: &str) -> String {
    parse_grid(text.as_bytes(), &Displacement::ByName)
        .and_then(Grid::into_volume_or_surface)
        .err()
        .unwrap()
        .to_string()
}

/// Files of meshio 5.3.5 and VTK 9.7.2 (`tests/vtk/make.py`).
fn file(name: &str) -> Vec<u8> {
    std::fs::read(format!("{}/tests/vtk/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// The displacements of the files, whose name is also one of velocities.
fn named_u() -> Displacement {
    Displacement::Named("U".into())
}

const FILES: [&str; 18] = [
    "meshio_42.vtk",
    "meshio_51.vtk",
    "meshio_ascii.vtu",
    "meshio_binary.vtu",
    "meshio_zlib.vtu",
    "vtk_42_ascii.vtk",
    "vtk_42_binary.vtk",
    "vtk_51_ascii.vtk",
    "vtk_51_binary.vtk",
    "vtk_ascii.vtu",
    "vtk_base64.vtu",
    "vtk_base64_zlib.vtu",
    "vtk_binary.vtu",
    "vtk_binary_zlib.vtu",
    "vtk_polydata.vtk",
    "vtk_raw.vtu",
    "vtk_raw_zlib.vtu",
    "vtk_raw_zlib_big.vtu",
];

#[test]
fn every_encoding_has_the_same_grid() {
    let unit = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let points: Vec<DVec3> = unit.into_iter().chain(unit.map(|p| p + DVec3::X * 2.0)).collect();
    for name in FILES {
        let unclear =
            parse_grid(&file(name), &Displacement::ByName).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!(unclear.displacement.is_none() && unclear.note().unwrap().contains("FILE#U applies it"));
        let grid = parse_grid(&file(name), &named_u()).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(grid.points, points, "{name}");
        let (array, vectors) = grid.displacement.as_ref().unwrap();
        let moved = DVec3::new(-1.75, 0.125, 0.125);
        let expected: Vec<DVec3> = (0..8).map(|v| if v < 4 { DVec3::ZERO } else { moved }).collect();
        assert_eq!((array.as_str(), vectors), ("U", &expected), "{name}");
        let (surface, warnings) = grid.moved().into_surface().unwrap();
        assert_eq!((surface.faces().len(), warnings.len()), (8, 0), "{name}");
        assert_eq!(surface.rest_positions()[5], DVec3::new(1.25, 0.125, 0.125), "{name}");
        if name != "vtk_polydata.vtk" {
            let volume = parse(&file(name)).unwrap();
            assert_eq!((volume.tets(), volume.vertices()), (&[[0, 1, 2, 3], [4, 5, 6, 7]][..], &points[..]));
        }
    }
}

/// Truncated files are refused, unless the missing end has no array, or only cuts the last number of a text. Every damaged
/// file is read or refused.
#[test]
fn damaged_files_are_errors() {
    for name in FILES {
        let whole = file(name);
        let read = |bytes: &[u8]| parse_grid(bytes, &named_u()).and_then(Grid::into_surface);
        let expected = read(&whole).unwrap();
        for length in (0..whole.len()).step_by(3) {
            let is_text = name == "meshio_42.vtk" || name.ends_with("ascii.vtk");
            if let (Ok(found), false) = (read(&whole[..length]), is_text) {
                assert_eq!(found.0.faces(), expected.0.faces(), "{name} cut to {length} bytes");
            }
        }
        let mut damaged = whole.clone();
        for at in (0..whole.len()).step_by(4) {
            for flip in [1, 0x80] {
                damaged[at] ^= flip;
                let _ = read(&damaged);
                damaged[at] ^= flip;
            }
        }
    }
}

#[test]
fn displacements_are_chosen_by_name() {
    let array = |name: &str, components: usize| {
        let text = "0.5 ".repeat(4 * components);
        format!(
            "<DataArray type='Float32' Name='{name}' NumberOfComponents='{components}'>{text}</DataArray>"
        )
    };
    let tet = ["0 1 2 3", "4", "10"];
    let name_of = |data: &str, wanted: &Displacement| {
        let grid = parse_grid(vtu(TET, tet, data).as_bytes(), wanted);
        grid.map(|grid| grid.displacement.map(|(name, _)| name)).map_err(|error| error.to_string())
    };
    let all = [array("velocity", 3), array("u", 3), array("Displacement", 3), array("disp", 1)].concat();
    assert_eq!(name_of(&all, &Displacement::ByName), Ok(Some("Displacement".into())));
    assert_eq!(name_of(&all, &Displacement::None), Ok(None));
    assert_eq!(name_of(&all, &Displacement::of_name(Some("velocity"))), Ok(Some("velocity".into())));
    for free in [array("velocity", 3), array("U", 3), array("U", 1)] {
        assert_eq!(name_of(&free, &Displacement::ByName), Ok(None));
    }
    assert_eq!(name_of(&array("U", 3), &named_u()), Ok(Some("U".into())));
    assert_eq!(
        name_of(&[array("U", 3), array("u", 3)].concat(), &Displacement::ByName),
        Ok(Some("u".into()))
    );
    let note = |data: &str, wanted: &Displacement| {
        parse_grid(vtu(TET, tet, data).as_bytes(), wanted).unwrap().note()
    };
    let line = "the point data 'U' may be displacements or velocities and does not move the points (FILE#U applies it)";
    assert_eq!(note(&array("U", 3), &Displacement::ByName).as_deref(), Some(line));
    assert_eq!(note(&array("U", 1), &Displacement::ByName), None);
    assert_eq!(note(&array("U", 3), &Displacement::None), None);
    let moved = "the point data 'u' moves the points (FILE# takes them as they are)";
    assert_eq!(note(&[array("U", 3), array("u", 3)].concat(), &Displacement::ByName).as_deref(), Some(moved));
    let message = name_of(&all, &Displacement::of_name(Some("disp"))).unwrap_err();
    assert_eq!(
        message,
        "point data: there are no vectors 'disp'; the point data has 'velocity', 'u', 'Displacement'"
    );
}

#[test]
fn cells_are_elements_and_faces() {
    // A voxel has another order of corners than a hexahedron.
    let cube = "0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1";
    let voxel = parse(vtu(cube, ["0 1 2 3 4 5 6 7", "8", "11"], "").as_bytes()).unwrap();
    let hexahedron = parse(vtu(cube, ["0 1 3 2 4 5 7 6", "8", "12"], "").as_bytes()).unwrap();
    assert_eq!(voxel, hexahedron);
    assert!(voxel.solid(&sscc_solid::PartialMaterial::default()).is_ok());
    // Middles: 01, 12, 20, 03, 13, 23.
    let middles = "0.5 0 0 0.5 0.5 0 0 0.5 0 0 0 0.5 0.5 0 0.5 0 0.5 0.5";
    let second = vtu(&format!("{TET} {middles}"), ["0 1 2 3 4 5 6 7 8 9", "10", "24"], "");
    let second = parse(second.as_bytes()).unwrap();
    assert_eq!(second.middles(), [[4, 5, 6, 7, 9, 8]]);
    assert!(second.solid(&sscc_solid::PartialMaterial::default()).is_ok());
    let faces = |connectivity: &str, offsets: &str, types: &str| {
        let text = vtu("0 0 0 1 0 0 0 1 0 1 1 0 0 2 0", [connectivity, offsets, types], "");
        parse_any(text.as_bytes()).unwrap().into_surface().unwrap().0.faces().to_vec()
    };
    assert_eq!(faces("0 1 2", "3", "5"), [[0, 1, 2]]);
    assert_eq!(faces("0 1 2 3", "4", "6"), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(faces("0 1 2 3", "4", "8"), [[0, 1, 3], [0, 3, 2]]);
    assert_eq!(faces("0 1 3 2", "4", "9"), faces("0 1 2 3", "4", "8"));
    assert_eq!(faces("0 1 3 4 2", "5", "7").len(), 3);
    // A vertex and a line have no surface.
    assert_eq!(faces("4 3 4 0 1 2", "1 3 6", "1 3 5"), [[0, 1, 2]]);
}

#[test]
fn bad_input_is_refused() {
    for (text, named) in [
        (
            vtu(TET, ["0 1 2 3", "4", "14"], ""),
            "cell 0 (counted from 0): a pyramid (cell type 14) is not supported",
        ),
        (vtu(TET, ["0 1 2 3", "4", "42"], ""), "a polyhedron (cell type 42)"),
        (vtu(TET, ["0 1 2 3", "4", "200"], ""), "cell type 200 is not supported"),
        (vtu(TET, ["0 1 2", "3", "10"], ""), "a cell of type 10 has 4 points, this one has 3"),
        (
            vtu(TET, ["0 1 2 4", "4", "10"], ""),
            "the element names vertex 4 (counted from 0), but there are 4",
        ),
        (
            vtu(TET, ["0 1 2 3 0 2 4294967297", "4 7", "10 7"], ""),
            "cell 1 (counted from 0): the face names vertex 4294967297 (counted from 0), but there are 4",
        ),
        (vtu(TET, ["0 1 2 2", "4", "10"], ""), "the element names vertex 2 (counted from 0) twice"),
        (vtu(TET, ["0 1 2 -3", "4", "10"], ""), "array 'connectivity': '-3' is no number of its type"),
        (vtu(TET, ["0 1 2 3", "5", "10"], ""), "array 'connectivity': it has 4 numbers, 5 are needed"),
        (vtu(TET, ["0 1 2 3 0 1 2", "4 3", "10 10"], ""), "it has 7 numbers, 3 are needed"),
        (
            vtu(TET, ["0 1 2", "4 3", "10 10"], ""),
            "cell 0 (counted from 0): its end in the connectivity is 4",
        ),
        (vtu(TET, ["0 1 2 3", "4", "23"], ""), "cell type 23 is not supported: only triangles and"),
        (
            vtu(TET, ["0 1 2 3", "4", "3"], ""),
            "no cell is a triangle, a polygon, a tetrahedron or a hexahedron: save the surface",
        ),
        (
            vtu("nan 0 0 1 0 0 0 1 0 0 0 1", ["0 1 2 3", "4", "10"], ""),
            "point 0 (counted from 0): a coordinate is not finite",
        ),
        (vtu("0 0 0", ["", "", ""], ""), "no cell is a triangle, a polygon"),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "").replace("UnstructuredGrid", "ImageData"),
            "line 2: the VTK file has the type 'ImageData': save it",
        ),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "")
                .replace("NumberOfPoints='4'", "NumberOfPoints='99999999999'"),
            "it has 12 numbers, 299999999997 are needed",
        ),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "").replace("NumberOfPoints='4'", ""),
            "'Piece' has no NumberOfPoints",
        ),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "").replace("</Piece>", "</Piece><Piece/>"),
            "a second piece of the grid",
        ),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "").replace("Name='types'", "Name='types' TimeStep='1'"),
            "has several time steps: save each",
        ),
        (vtu(TET, ["0 1 2 3", "4", "10"], "").replace("</Points>", "</Pts>"), "malformed XML"),
        (
            vtu(TET, ["0 1 2 3", "4", "10"], "").replace("</UnstructuredGrid></VTKFile>", ""),
            "line 3: the file ends within 'UnstructuredGrid': is it cut off?",
        ),
        ("<a/>".into(), "no VTK file"),
        ("hello".into(), "no VTK file"),
    ] {
        let message = refused(&text);
        assert!(message.contains(named) && !message.contains('\n'), "{named}: {message}");
    }
    let message = parse_grid(&file("vtk_binary_lz4.vtu"), &Displacement::ByName).err().unwrap().to_string();
    assert!(message.contains("compressed by 'vtkLZ4DataCompressor': save it with zlib"), "{message}");
    let binary = |text: &str| {
        let kind = "type='Float64' NumberOfComponents='3' format=";
        let whole = vtu(TET, ["0 1 2 3", "4", "10"], "")
            .replace(&format!("{kind}'ascii'>{TET}"), &format!("{kind}{text}"));
        refused(&whole)
    };
    for (text, named) in [
        ("'binary'>YAAAAA==", "96 bytes are needed, 0 are left: is the file cut off?"),
        ("'binary'>/////w==", "the file states 4294967295 bytes, its numbers of points and cells need 96"),
        ("'binary'>YAAAA", "its base64 text is damaged or cut off"),
        ("'appended' offset='0'>", "the file has no appended data"),
        ("'appended'>", "has no offset"),
        ("'hdf'>", "format 'hdf' is not known"),
    ] {
        let message = binary(text);
        assert!(message.contains(named), "{text}: {message}");
    }
    // False sizes reserve no memory.
    let large =
        vtu(TET, ["0 1 2 3", "4", "10"], "").replace("NumberOfPoints='4'", "NumberOfPoints='999999999999'");
    let large = large.replace("'3' format='ascii'>", "'3' format='binary'>");
    assert!(refused(&large).contains("too much for a file of this size"), "{}", refused(&large));
}

#[test]
fn bad_legacy_files_are_refused() {
    let head = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\n";
    let points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    let cells = "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n";
    let whole = format!("{head}{points}{cells}");
    assert_eq!(parse(whole.as_bytes()).unwrap().tets(), [[0, 1, 2, 3]]);
    for (text, named) in [
        (head.replace("ASCII", "HDF"), "line 3: ASCII or BINARY was expected, not 'HDF'"),
        (head.replace("UNSTRUCTURED_GRID", "STRUCTURED_GRID"), "a data set of kind 'STRUCTURED_GRID'"),
        (head.to_owned(), "the file has no POINTS"),
        (format!("{head}{points}"), "the file has 0 cells and 0 types of cells"),
        (format!("{head}POINTS 99999999999 double\n0 0"), "the file ends before a coordinate"),
        (format!("{head}POINTS 4 bit\n"), "line 5: numbers of type 'bit' are not supported"),
        (whole.replace("CELLS 1 5", "CELLS 2 5"), "cell 1 (counted from 0) leaves the 5 numbers"),
        (whole.replace("4 0 1 2 3", "9 0 1 2 3"), "cell 0 (counted from 0) leaves the 5 numbers"),
        (whole.replace("\n10\n", "\n13\n"), "a wedge (cell type 13) is not supported"),
        (
            format!("{whole}POINT_DATA 3\nVECTORS u float\n0 0 0 0 0 0 0 0 0\n"),
            "'u' has 3 vectors for 4 points",
        ),
        (format!("{whole}SPLINES 3\n"), "line 11: 'SPLINES' is no known part of a grid"),
        (
            format!("{whole}POINT_DATA 4\nVECTORS u bit\n0 0 0 0 0 0 0 0 0 0 0 1\n"),
            "line 12: numbers of type 'bit' are not supported",
        ),
        (
            format!("{whole}POINT_DATA 4\nFIELD f 1\nu 3 4 string\na\n"),
            "line 13: numbers were expected, not texts",
        ),
        (format!("{whole}POINT_DATA 4\nFIELD f 1\nx 1 4 string\na\n"), "the file ends before an item of 'x'"),
        (
            whole.replace("ASCII", "BINARY"),
            "the file ends before a coordinate: 96 bytes are needed, 60 are left",
        ),
    ] {
        let message = refused(&text);
        assert!(message.contains(named), "{named}: {message}");
    }
    // Attributes of other kinds are skipped, also values that are no numbers.
    let data = "CELL_DATA 1\nSCALARS a float\nLOOKUP_TABLE default\nnan\nMETADATA\nINFORMATION 0\n\nPOINT_DATA 4\n\
                FIELD f 2\nx 1 4 int\n1 2 3 4\nu 3 4 float\n0 0 0 0 0 0 0 0 0 0 0 2\nTENSORS t float\n";
    let text = format!("{whole}{data}{}", "1 ".repeat(36));
    let grid = parse_grid(text.as_bytes(), &Displacement::ByName).unwrap();
    assert_eq!(grid.moved().points[3], DVec3::new(0.0, 0.0, 3.0));
}

#[test]
fn surplus_numbers_and_repeated_parts_of_legacy_files_are_refused() {
    let head = "# vtk DataFile Version 5.1\ntitle\nASCII\nDATASET ";
    let points = "POINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n";
    let grid = format!("{head}UNSTRUCTURED_GRID\n{points}");
    let lists = "OFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\n";
    let types = "CELL_TYPES 1\n10\n";
    let whole = format!("{grid}CELLS 2 4\n{lists}{types}");
    assert_eq!(parse(whole.as_bytes()).unwrap().tets(), [[0, 1, 2, 3]]);
    let polygons = "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY vtktypeint64\n0 1 2\n";
    let surface = format!("{head}POLYDATA\n{points}{polygons}");
    assert!(parse_any(surface.as_bytes()).is_ok());
    for (text, named) in [
        (
            format!("{grid}CELLS 1 10\n4 0 1 2 3 4 1 2 3 4\n{types}"),
            "line 8: CELLS has 10 numbers, but its 1 cells take 5 of them: correct its counts, or save the grid again",
        ),
        (
            whole.replace("\n0 4\n", "\n1 4\n"),
            "line 9: the first offset is 1, but offsets begin with 0: correct it, or save the grid again",
        ),
        (
            surface.replace("\n0 3\n", "\n0 2\n"),
            "line 9: the last offset is 2, but the list has 3 corners: correct its counts, or save the grid again",
        ),
        (format!("{whole}{points}"), "line 14: there is a second POINTS: save each grid as a file"),
        (format!("{whole}{types}"), "line 14: there is a second CELL_TYPES: save each grid as a file"),
        (
            whole.replace(types, &format!("CELLS 2 4\n{lists}CELL_TYPES 2\n10 10\n")),
            "line 12: there is a second CELLS: save each grid as a file",
        ),
        (format!("{surface}{polygons}"), "line 12: there is a second POLYGONS: save each grid as a file"),
    ] {
        assert_eq!(refused(&text), named);
    }
}

const LEGACY: &str = "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
    0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n";

#[test]
fn only_vectors_and_fields_of_legacy_files_are_displacements() {
    let numbers = "0 0 0 0 0 0 0 0 0 0 0 1\n";
    for (data, is_moved) in [
        ("VECTORS u float\n", true),
        ("FIELD f 1\nu 3 4 float\n", true),
        ("NORMALS u float\n", false),
        ("SCALARS u float 3\nLOOKUP_TABLE default\n", false),
        ("TEXTURE_COORDINATES u 3 float\n", false),
    ] {
        let text = format!("{LEGACY}{data}{numbers}");
        for wanted in [Displacement::ByName, Displacement::Named("u".into())] {
            let grid = parse_grid(text.as_bytes(), &wanted);
            let found = grid.is_ok_and(|grid| grid.displacement.is_some());
            assert_eq!(found, is_moved, "{data}");
        }
    }
}

#[test]
fn bits_and_texts_of_legacy_files_are_skipped() {
    // Texts are lines, which may be empty.
    let text = format!(
        "{LEGACY}SCALARS b bit\nLOOKUP_TABLE default\n1 0 1 1\nFIELD f 3\ns 1 4 string\na\n\nb%20c\nu\nb 1 4 bit\n\
         0 1 0 1\nu 3 4 float\n0 0 0 0 0 0 0 0 0 0 0 2\n"
    );
    let grid = parse_grid(text.as_bytes(), &Displacement::ByName).unwrap();
    assert_eq!(grid.moved().points[3], DVec3::new(0.0, 0.0, 3.0));

    let mut binary =
        b"# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n".to_vec();
    let numbers = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0_f64];
    binary.extend(numbers.iter().flat_map(|x| x.to_be_bytes()));
    binary.extend(b"\nCELLS 1 5\n");
    binary.extend([4, 0, 1, 2, 3_i32].iter().flat_map(|v| v.to_be_bytes()));
    binary.extend(b"\nCELL_TYPES 1\n\0\0\0\x0a\nPOINT_DATA 4\nFIELD f 3\nb 3 4 bit\n");
    binary.extend([0xa5, 0xf0]);
    // Lengths of 1, 2, 4 and 8 bytes.
    binary.extend(b"\ns 1 4 string\n");
    binary.extend(b"\xc2ab\x80\x01c\x40\0\0\x03def\0\0\0\0\0\0\0\x01g");
    let cut = binary.len();
    binary.extend(b"\nu 3 4 double\n");
    binary.extend(numbers.iter().flat_map(|x| x.to_be_bytes()));
    let grid = parse_grid(&binary, &Displacement::ByName).unwrap();
    assert_eq!(grid.moved().points[3], DVec3::new(0.0, 0.0, 2.0));
    for length in cut - 21..cut {
        assert!(parse_grid(&binary[..length], &Displacement::None).is_err(), "{length}");
    }
    binary[cut - 9] = 0x3f;
    let message = parse_grid(&binary, &Displacement::None).err().unwrap().to_string();
    assert!(message.contains("the file ends before an item of 's'"), "{message}");
}

/// No part of the text of an array is dropped.
#[test]
fn references_and_cdata_in_arrays_are_refused() {
    let whole = vtu(TET, ["0 1 2 3", "4", "10"], "");
    assert!(parse(whole.as_bytes()).is_ok());
    for (part, named) in [
        ("&#45;5", "line 6: character references are not supported in arrays"),
        ("5&#48;", "line 6: character references are not supported in arrays"),
        ("&amp;", "line 6: character references are not supported in arrays"),
        ("<![CDATA[5]]>", "line 6: CDATA sections are not supported in arrays"),
        ("1<![CDATA[5]]>", "line 6: CDATA sections are not supported in arrays"),
    ] {
        for numbers in [format!("{part} 1 2 3"), format!("0 1 {part} 3"), format!("0 1 2 {part}")] {
            let message = refused(&whole.replace("\n0 1 2 3\n", &format!("\n{numbers}\n")));
            assert!(message == named, "{numbers}: {message}");
        }
    }
    let message = refused(&whole.replace("\n0 1 2 3\n", "\n0 1 2<!-- x --> 3\n"));
    assert!(message.contains("the text of an array is in several parts"), "{message}");
    // Outside of arrays, references and CDATA sections are allowed.
    let named =
        whole.replace("<PointData>", "<FieldData><Array>a&amp;b<![CDATA[c]]></Array></FieldData><PointData>");
    assert!(parse(named.as_bytes()).is_ok());
}

#[test]
fn encodings_of_appended_data_are_compared_exactly() {
    let raw = file("vtk_raw.vtu");
    let with = |encoding: &[u8]| {
        let from = b"encoding=\"raw\"";
        let at = raw.windows(from.len()).position(|window| window == from).unwrap();
        let bytes = [&raw[..at], encoding, &raw[at + from.len()..]].concat();
        parse_grid(&bytes, &Displacement::None)
            .map(|grid| grid.points.len())
            .map_err(|error| error.to_string())
    };
    assert_eq!((with(b"encoding='raw'"), with(b"raw='base64' encoding=\"raw\"")), (Ok(8), Ok(8)));
    for bad in [
        "encoding='rawer'",
        "encoding='RAW'",
        "raw='1'",
        "encoding=raw",
        "encoding='' raw=''",
        "encoding='raw' encoding='base64'",
        "encoding='raw' encoding='raw'",
    ] {
        assert_eq!(
            with(bad.as_bytes()).unwrap_err(),
            "AppendedData: its encoding must be stated once, as 'raw' or as 'base64'",
            "{bad}"
        );
    }
}

/// Which of two equal names the file means is unknown.
#[test]
fn repeated_attributes_and_arrays_are_refused() {
    let whole = vtu(TET, ["0 1 2 3", "4", "10"], "");
    assert!(parse(whole.as_bytes()).is_ok());
    for (from, to, named) in [
        ("<Piece ", "<Piece NumberOfPoints='4' ", "line 3: 'Piece' has two attributes 'NumberOfPoints'"),
        (
            "Name='types'",
            "Name='connectivity' Name='types'",
            "line 11: 'DataArray' has two attributes 'Name': remove one of them, or save the file again",
        ),
        (
            "version='1.0' b",
            "version='1.0' type='ImageData' b",
            "line 2: 'VTKFile' has two attributes 'type'",
        ),
        (
            "</Points>",
            "<DataArray type='Float64'>0 0 0 2 0 0 0 1 0 0 0 1</DataArray></Points>",
            "line 15: there is a second array in 'Points': remove one of the two, or save the grid again",
        ),
        (
            "</Piece>",
            "<Points><DataArray type='Float64'>0 0 0</DataArray></Points></Piece>",
            "line 16: there is a second array in 'Points'",
        ),
        (
            "</Cells>",
            "<DataArray type='Int64' Name='connectivity'>0 1 3 2</DataArray></Cells>",
            "line 14: there is a second array 'connectivity' in 'Cells'",
        ),
        (
            "</Piece>",
            "<Cells><DataArray type='Int64' Name='offsets'>4</DataArray></Cells></Piece>",
            "line 16: there is a second array 'offsets' in 'Cells'",
        ),
        (
            "</Cells>",
            "<DataArray type='UInt8' Name='types'>10</DataArray></Cells>",
            "line 14: there is a second array 'types' in 'Cells'",
        ),
    ] {
        assert_eq!(whole.matches(from).count(), 1, "{from}");
        let message = refused(&whole.replace(from, to));
        assert!(message.starts_with(named), "{named}: {message}");
    }
    // Other arrays of cells may be there.
    let more = whole.replace("</Cells>", "<DataArray type='Int64' Name='faces'>0</DataArray></Cells>");
    assert!(parse(more.as_bytes()).is_ok());
}

#[test]
fn repeated_displacements_are_refused() {
    let array = |name: &str, components: usize| {
        let text = "0.5 ".repeat(4 * components);
        format!(
            "<DataArray type='Float32' Name='{name}' NumberOfComponents='{components}'>{text}</DataArray>"
        )
    };
    let tet = ["0 1 2 3", "4", "10"];
    let xml = |data: &str| vtu(TET, tet, data);
    let numbers = "0 0 0 0 0 0 0 0 0 0 0 1\n";
    let legacy = |names: &[&str]| {
        let vectors = names.iter().map(|name| format!("VECTORS {name} float\n{numbers}"));
        format!("{LEGACY}{}", vectors.collect::<String>())
    };
    let field = format!("{LEGACY}VECTORS u float\n{numbers}FIELD f 1\nu 3 4 float\n{numbers}");
    let cause = "point data: there are two arrays of vectors 'u': rename or remove one (FILE# takes the points as they are)";
    for text in [xml(&[array("u", 3), array("u", 3)].concat()), legacy(&["u", "u"]), field] {
        assert_eq!(refused(&text), cause);
        let named = parse_grid(text.as_bytes(), &Displacement::Named("u".into()));
        assert_eq!(named.err().unwrap().to_string(), cause);
        assert!(parse_grid(text.as_bytes(), &Displacement::None).is_ok());
    }
    // Arrays of other names or sizes decide nothing.
    let others = [array("v", 3), array("v", 3), array("u", 3), array("u", 1)].concat();
    for text in [xml(&others), legacy(&["v", "v", "u"])] {
        let grid = parse_grid(text.as_bytes(), &Displacement::ByName).unwrap();
        assert_eq!(grid.displacement.unwrap().0, "u");
    }
}
