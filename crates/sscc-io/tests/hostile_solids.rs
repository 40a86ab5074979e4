//! Random and damaged volumetric meshes and reduced forces: each parser returns a valid mesh or an error, with little
//! memory.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use allocation_counter::measure;
use proptest::prelude::*;
use sscc_io::solid::{gmsh, medit, tetgen, vega, vtk};
use sscc_io::{FormatError, VolumeOrSurface, parse_reduced_forces};
use sscc_solid::VolumeMesh;

/// Checks the guarantees of every mesh, and that errors have one line.
fn check(result: Result<VolumeMesh, FormatError>) {
    match result {
        Ok(mesh) => {
            let vertices = mesh.vertices().len();
            let corners =
                [mesh.tets().as_flattened(), mesh.cubes().as_flattened(), mesh.surface().as_flattened()];
            assert!(corners.concat().iter().all(|v| (*v as usize) < vertices));
            assert!(mesh.vertices().iter().all(|x| sscc::limits::contains(*x)));
            let elements = mesh.tets().len() + mesh.cubes().len();
            assert!(elements > 0 && mesh.element_material().len() == elements);
            assert!(mesh.element_material().iter().all(|m| (*m as usize) < mesh.materials().len()));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(!message.is_empty() && !message.contains('\n') && message.len() < 400, "{message}");
        }
    }
}

fn check_any(result: Result<VolumeOrSurface, FormatError>) {
    match result {
        Ok(VolumeOrSurface::Volume { mesh, .. }) => check(Ok(mesh)),
        Ok(VolumeOrSurface::Surface { mesh, .. }) => assert!(!mesh.faces().is_empty()),
        Err(error) => check(Err(error)),
    }
}

fn parse_all(bytes: &[u8]) {
    check(medit::parse(bytes));
    check(vega::parse(bytes));
    check(gmsh::parse(bytes));
    check_any(medit::parse_any(bytes));
    check_any(gmsh::parse_any(bytes));
    check_any(vtk::parse_any(bytes));
    match tetgen::parse_nodes(bytes) {
        Ok(nodes) => check(tetgen::parse(&nodes, ELE)),
        Err(error) => check(Err(error)),
    }
    check(tetgen::parse(&tetgen::parse_nodes(NODE).unwrap(), bytes));
    if let Err(error) = parse_reduced_forces(bytes) {
        check(Err(error));
    }
}

const NODE: &[u8] = b"4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n";
const ELE: &[u8] = b"1 4 1\n0 0 1 2 3 5\n";

const VTU: &[u8] = b"<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\" 4 \" NumberOfCells=\" 1 \"><Cells>\
    <DataArray type=\"Int64\" Name=\"connectivity\" > 0 1 2 3 </DataArray><DataArray type=\"Int64\" Name=\"offsets\" > 4 </DataArray>\
    <DataArray type=\"UInt8\" Name=\"types\" > 10 </DataArray></Cells><Points><DataArray type=\"Float64\" NumberOfComponents=\" 3 \" >\
    0 0 0 1 0 0 0 1 0 0 0 1 </DataArray></Points></Piece></UnstructuredGrid></VTKFile>";
const VTK: &[u8] = b"# vtk DataFile Version 5.1\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n\
    CELLS 2 4\nOFFSETS vtktypeint64\n0 4\nCONNECTIVITY vtktypeint64\n0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nFIELD f 1\n\
    U 3 4 double\n0 0 0 0 0 0 0 0 0 0 0 1\n";

/// Small valid files.
fn seeds() -> Vec<Vec<u8>> {
    let points = "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
    let medit = "MeshVersionFormatted 1\nDimension 3\nVertices 4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\nTriangles 1\n\
        1 2 3 0\nTetrahedra 1\n1 2 3 4 0\nEnd\n";
    let vega = format!(
        "*VERTICES\n4 3 0 0\n{points}*ELEMENTS\nTET\n1 4 0\n1 1 2 3 4\n*MATERIAL a\nENU, 1, 2, 0.3\n*SET s\n1\n\
         *REGION\ns, a\n"
    );
    let v2 = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n4\n{points}$EndNodes\n$Elements\n1\n1 4 2 1 1 1 2 3 4\n\
         $EndElements\n"
    );
    let v4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 0 1\n1 0 0 0 1 1 1 1 5 0\n$EndEntities\n$Nodes\n\
        1 4 1 4\n3 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n$Elements\n1 1 1 1\n3 1 4 1\n1 1 2 3 4\n\
        $EndElements\n";
    let mut binary = b"$MeshFormat\n4.1 1 8\n\x01\0\0\0\n$EndMeshFormat\n$Nodes\n".to_vec();
    let sizes = |binary: &mut Vec<u8>, values: &[u64]| {
        values.iter().for_each(|v| binary.extend(v.to_le_bytes()));
    };
    sizes(&mut binary, &[1, 4, 1, 4]);
    [3_i32, 1, 0].iter().for_each(|v| binary.extend(v.to_le_bytes()));
    sizes(&mut binary, &[4, 1, 2, 3, 4]);
    let positions = [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1].map(f64::from);
    positions.iter().for_each(|v| binary.extend(v.to_le_bytes()));
    binary.extend(b"\n$EndNodes\n$Elements\n");
    sizes(&mut binary, &[1, 1, 1, 1]);
    [3_i32, 1, 4].iter().for_each(|v| binary.extend(v.to_le_bytes()));
    sizes(&mut binary, &[1, 1, 1, 2, 3, 4]);
    binary.extend(b"\n$EndElements\n");
    let second_order = format!(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n{points}5 .5 0 0\n6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n9 0 .5 .5\n\
         10 .5 0 .5\n$EndNodes\n$Elements\n2\n1 9 2 1 1 1 3 2 7 6 5\n2 11 2 1 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n"
    );
    let cubic = [&[1, 0, 0, 0].repeat(4)[..], &[0; 24]].concat();
    let (medit, v4) = (medit.as_bytes().to_vec(), v4.as_bytes().to_vec());
    let (v2, second_order) = (v2.into_bytes(), second_order.into_bytes());
    let (vtu, vtk) = (VTU.to_vec(), VTK.to_vec());
    vec![medit, vega.into_bytes(), v2, v4, binary, NODE.to_vec(), ELE.to_vec(), cubic, second_order, vtu, vtk]
}

#[test]
fn seeds_are_valid() {
    let seeds = seeds();
    let meshes = [
        medit::parse(&seeds[0]),
        vega::parse(&seeds[1]),
        gmsh::parse(&seeds[2]),
        gmsh::parse(&seeds[3]),
        gmsh::parse(&seeds[4]),
        tetgen::parse(&tetgen::parse_nodes(&seeds[5]).unwrap(), &seeds[6]),
        vtk::parse(&seeds[9]),
        vtk::parse(&seeds[10]),
    ];
    for mesh in meshes {
        let mesh = mesh.unwrap();
        assert_eq!((mesh.tets(), mesh.vertices().len()), (&[[0, 1, 2, 3]][..], 4));
        check(Ok(mesh));
    }
    assert_eq!(parse_reduced_forces(&seeds[7]).unwrap().rank(), 1);
    let second_order = gmsh::parse(&seeds[8]).unwrap();
    assert_eq!((second_order.middles().len(), second_order.vertices().len()), (1, 10));
    check(Ok(second_order));
}

proptest! {
    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        parse_all(&bytes);
    }

    #[test]
    fn random_words(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "MeshVersionFormatted", "Dimension", "Vertices", "Tetrahedra", "Hexahedra", "Triangles", "Ridges",
                "End", "*VERTICES", "*ELEMENTS", "TET", "CUBIC", "*MATERIAL a", "ENU,1,2,0.3", "*SET a", "*REGION",
                "a,a", "allElements,a", "*INCLUDE a", "$MeshFormat", "$EndMeshFormat", "$Nodes", "$EndNodes",
                "$Elements", "$EndElements", "$Entities", "$PhysicalNames", "\"a\"", "4.1", "2.2", "0", "1", "2", "3",
                "4", "8", "-1", "18446744073709551615", "9223372036854775807", "1e999", "nan", "#", ",", "\n", "\n",
                "\r\n", "\u{e9}",
            ]),
            0..80,
        ),
        start in prop::sample::select(vec![
            "", "MeshVersionFormatted 1 Dimension 3 ", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n",
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "*VERTICES\n1\n0 0 0 0\n",
        ]),
        joint in prop::sample::select(vec![" ", "\n", ""]),
    ) {
        parse_all(format!("{start}{}", words.join(joint)).as_bytes());
    }

    #[test]
    fn damaged_files(
        seed in 0_usize..11,
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

    /// Files of VTK in all encodings.
    #[test]
    fn damaged_vtk_files(
        name in prop::sample::select(vec![
            "meshio_zlib.vtu", "vtk_ascii.vtu", "vtk_base64_zlib.vtu", "vtk_binary.vtu", "vtk_binary_zlib.vtu", "vtk_raw.vtu",
            "vtk_raw_zlib_big.vtu", "vtk_42_binary.vtk", "vtk_51_ascii.vtk", "vtk_polydata.vtk",
        ]),
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
        part in prop::sample::select(vec!["", "", "&#45;", "<![CDATA[5]]>", "<!-- -->", "<", "'", "-1 "]),
        at in any::<prop::sample::Index>(),
        cut in any::<prop::sample::Index>(),
        whole: bool,
    ) {
        let path = format!("{}/tests/vtk/{name}", env!("CARGO_MANIFEST_DIR"));
        let mut bytes = std::fs::read(path).unwrap();
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let at = at.index(bytes.len());
        bytes.splice(at..at, part.bytes());
        let len = if whole { bytes.len() } else { cut.index(bytes.len()) };
        check_any(vtk::parse_any(&bytes[..len]));
    }

    /// Damage of single bytes seldom exchanges numbers.
    #[test]
    fn exchanged_numbers(
        seed in 0_usize..11,
        at in prop::collection::vec(any::<prop::sample::Index>(), 1..4),
        number in prop::sample::select(vec!["0", "1", "2", "5", "15", "-1", "4294967296", "18446744073709551615"]),
    ) {
        let Ok(text) = String::from_utf8(seeds().swap_remove(seed)) else { return Ok(()) };
        let mut words: Vec<_> = text.split_inclusive(char::is_whitespace).map(str::to_owned).collect();
        for at in at {
            let word = &mut words[at.index(text.split_inclusive(char::is_whitespace).count())];
            if word.trim().parse::<f64>().is_ok() {
                *word = word.replace(word.trim(), number);
            }
        }
        parse_all(words.concat().as_bytes());
    }
}

/// Returns the peak memory of a function in bytes.
fn peak(run: impl FnOnce()) -> u64 {
    measure(run).bytes_max
}

#[test]
fn declared_counts_allocate_nothing() {
    for count in ["1000000000", "9223372036854775807", "18446744073709551615"] {
        for seed in seeds() {
            let Ok(text) = String::from_utf8(seed) else { continue };
            let words: Vec<_> = text.split_inclusive(char::is_whitespace).collect();
            for at in 0..words.len() {
                if words[at].trim().parse::<u64>().is_ok() {
                    let mut words = words.clone();
                    words[at] = count;
                    let text = words.join(" ");
                    assert!(peak(|| parse_all(text.as_bytes())) < 50_000, "{text}");
                }
            }
        }
    }
    // Each byte of the binary file, also of its counts, is set to 255.
    let binary = seeds().swap_remove(4);
    for at in 0..binary.len() {
        let mut bytes = binary.clone();
        bytes[at] = 0xff;
        assert!(peak(|| parse_all(&bytes)) < 50_000, "{at}");
    }
    let huge = [1 << 20, 1 << 20, 0x7fff_ffff, -1_i32].map(i32::to_le_bytes).concat();
    assert!(peak(|| assert!(parse_reduced_forces(&huge).is_err())) < 10_000);
}

/// Long files with the shortest valid lines use little memory per byte.
#[test]
fn long_files_use_little_memory() {
    let many = |text: &str| text.repeat(100_000);
    let numbered =
        |text: &str| -> String { (0..100_000).map(|i| text.replace('@', &i.to_string())).collect() };
    let start = String::from_utf8(seeds().swap_remove(1)).unwrap();
    let groups = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n";
    for text in [
        format!("MeshVersionFormatted 1 Dimension 3 Vertices 100000{}", many(" 0 0 0 0")),
        format!("MeshVersionFormatted 1 Dimension 3 Tetrahedra 100000{}", numbered(" 1 2 3 4 @")),
        format!("MeshVersionFormatted 1{}", many(" A")),
        format!("{start}*SET t\n{}", many("1,")),
        format!("{start}{}", numbered("*SET @\n")),
        format!("{start}{}", numbered("*MATERIAL @\nENU,1,1,0\n")),
        // Many regions refer to one large set.
        format!("{start}*SET t\n{}\n{}", many("1,"), many("*REGION\nt,a\n")),
        format!("{start}{}", many("*REGION\nallElements,a\n")),
        format!("{groups}$PhysicalNames\n100000\n{}", numbered("3 @ \"\"\n")),
        format!("{groups}$Entities\n0 0 0 100000\n{}", numbered("@ 0 0 0 0 0 0 1 1 0\n")),
        format!("{groups}{}", many("$A\n$EndA\n")),
        String::from_utf8_lossy(VTU).replace("<Cells>", &format!("{}<Cells>", many("<a/>"))),
        String::from_utf8_lossy(VTU).replace("<Cells>", &format!("{}<Cells>", many("<a>"))),
        String::from_utf8_lossy(VTU).replace("<Cells>", &format!("<Cells{}>", numbered(" a@=''"))),
        String::from_utf8_lossy(VTU)
            .replace("<Cells>", &format!("<a>{}</a><Cells>", many("&#45;<![CDATA[]]>"))),
        String::from_utf8_lossy(VTU).replace("0 1 2 3", &many("&#48; ")),
        String::from_utf8_lossy(VTU)
            .replace("0 1 2 3", &many("0 "))
            .replace("> 4 <", "> 100000 <")
            .replace("> 10 <", "> 7 <"),
    ] {
        let peak = peak(|| parse_all(text.as_bytes()));
        assert!(peak < 50 * text.len() as u64, "{peak} for {}: {}", text.len(), &text[..60]);
    }
}
