use glam::DVec3;

use super::*;

const V2: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"skin\"\n3 5 \"soft body\"\n\
    $EndPhysicalNames\n$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n7 1 1 1\n$EndNodes\n$Elements\n4\n\
    1 15 2 0 1 10\n2 2 2 1 1 10 20 30\n3 4 2 5 1 10 20 30 40\n4 4 2 6 1 20 30 40 7\n$EndElements\n";

const V4: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 5 \"soft body\"\n$EndPhysicalNames\n\
    $Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 1 1 -1 0\n1 0 0 0 1 1 1 2 5 6 1 -1\n2 0 0 0 1 1 1 1 6 0\n$EndEntities\n\
    $Nodes\n2 5 7 40\n2 1 1 3\n10\n20\n30\n0 0 0 0 0\n1 0 0 1 0\n0 1 0 0 1\n3 1 0 2\n40\n7\n0 0 1\n1 1 1\n$EndNodes\n\
    $Elements\n4 4 1 4\n0 1 15 1\n1 10\n2 1 2 1\n2 10 20 30\n3 1 4 1\n3 10 20 30 40\n3 2 4 1\n4 20 30 40 7\n$EndElements\n";

fn message(text: &str) -> String {
    parse(text.as_bytes()).unwrap_err().to_string()
}

fn check(mesh: &VolumeMesh) {
    assert_eq!(mesh.vertices(), [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE]);
    assert_eq!(mesh.tets(), [[0, 1, 2, 3], [1, 2, 3, 4]]);
    assert_eq!(mesh.surface(), [[0, 1, 2]]);
    let names: Vec<_> = mesh.materials().iter().map(|m| m.name.as_str()).collect();
    assert_eq!((names, mesh.element_material()), (vec!["soft body", "6"], &[0, 1][..]));
}

/// Returns the same file in binary. Parts without number words are text; the letters `i`, `s`, `d` are number types.
fn binary(version: Version, big_endian: bool) -> Vec<u8> {
    let text = match version {
        Version::V2 => {
            "$MeshFormat\n|2.2 1 8\n|i1 \n|$EndMeshFormat\n|$PhysicalNames\n|2\n|2 1 \"skin\"\n|3 5 \"soft body\"\n|\
             $EndPhysicalNames\n|$Nodes\n|5\n|i10 d0 d0 d0 i20 d1 d0 d0 i30 d0 d1 d0 i40 d0 d0 d1 i7 d1 d1 d1 \n|\
             $EndNodes\n|$Elements\n|4\n|i15 i1 i2 i1 i0 i1 i10 i2 i1 i2 i2 i1 i1 i10 i20 i30 \
             i4 i2 i2 i3 i5 i1 i10 i20 i30 i40 i4 i6 i1 i20 i30 i40 i7 \n|$EndElements\n"
        }
        Version::V4 => {
            "$MeshFormat\n|4.1 1 8\n|i1 \n|$EndMeshFormat\n|$PhysicalNames\n|1\n|3 5 \"soft body\"\n|$EndPhysicalNames\n|\
             $Entities\n|s1 s0 s1 s2 i1 d0 d0 d0 s0 i1 d0 d0 d0 d1 d1 d1 s1 i-1 s0 i1 d0 d0 d0 d1 d1 d1 s2 i5 i6 s1 \
             i-1 i2 d0 d0 d0 d1 d1 d1 s1 i6 s0 \n|$EndEntities\n|$Nodes\n|s2 s5 s7 s40 i2 i1 i1 s3 s10 s20 s30 \
             d0 d0 d0 d0 d0 d1 d0 d0 d1 d0 d0 d1 d0 d0 d1 i3 i1 i0 s2 s40 s7 d0 d0 d1 d1 d1 d1 \n|$EndNodes\n|\
             $Elements\n|s4 s4 s1 s4 i0 i1 i15 s1 s1 s10 i2 i1 i2 s1 s2 s10 s20 s30 i3 i1 i4 s1 s3 s10 s20 s30 s40 \
             i3 i2 i4 s1 s4 s20 s30 s40 s7 \n|$EndElements\n"
        }
    };
    let order = |mut bytes: Vec<u8>| {
        if big_endian {
            bytes.reverse();
        }
        bytes
    };
    let mut file = Vec::new();
    for part in text.split('|') {
        if !part.ends_with(" \n") {
            file.extend(part.bytes());
            continue;
        }
        for word in part.split_ascii_whitespace() {
            file.extend(order(match word.split_at(1) {
                ("i", value) => value.parse::<i32>().unwrap().to_le_bytes().to_vec(),
                ("s", value) => value.parse::<u64>().unwrap().to_le_bytes().to_vec(),
                (_, value) => value.parse::<f64>().unwrap().to_le_bytes().to_vec(),
            }));
        }
        file.push(b'\n');
    }
    file
}

#[test]
fn all_dialects_give_the_same_mesh() {
    check(&parse(V2.as_bytes()).unwrap());
    check(&parse(V4.as_bytes()).unwrap());
    for version in [Version::V2, Version::V4] {
        for big_endian in [false, true] {
            check(&parse(&binary(version, big_endian)).unwrap());
        }
    }
    check(&parse(V4.replace('\n', "\r\n").as_bytes()).unwrap());
    check(&parse(V2.replace('\n', "\r").as_bytes()).unwrap());
    let other = "$Comments\nanything $Nodes\n$EndComments\n";
    check(&parse(V2.replace("$Nodes", &format!("{other}$Nodes")).as_bytes()).unwrap());
}

#[test]
fn blocks_have_at_least_one_element_and_at_most_those_of_the_section() {
    let mut file = binary(Version::V2, false);
    let start = b"$Elements\n4\n";
    let at = file.windows(start.len()).position(|window| window == start).unwrap() + start.len();
    // The count comes after the kind of the block.
    for (count, cause) in [
        (0_i32, "a block has 0 elements: it must have at least one"),
        (5, "a block has 5 elements, but only 4 of the section remain"),
    ] {
        file[at + 4..at + 8].copy_from_slice(&count.to_le_bytes());
        let message = parse(&file).unwrap_err().to_string();
        assert!(message.ends_with(cause), "{message}");
    }
}

#[test]
fn parametric_nodes_of_version_2() {
    let nodes = "$Nodes\n5\n10 0 0 0\n20 1 0 0\n30 0 1 0\n40 0 0 1\n7 1 1 1\n$EndNodes\n";
    assert!(V2.contains(nodes));
    let parametric = "$ParametricNodes\n5\n10 0 0 0 0 1\n20 1 0 0 3 1 .1 .1 .1\n30 0 1 0 2 1 .5 .5\n40 0 0 1 1 1 0.5\n\
        7 1 1 1 3 1 0 0 0\n$EndParametricNodes\n";
    let text = V2.replace(nodes, parametric);
    check(&parse(text.as_bytes()).unwrap());
    check(&parse(text.replace('\n', "\r").as_bytes()).unwrap());
    assert_eq!(message(&text.replace("30 0 1 0 2", "30 0 1 x 2")), "line 13: 'x' is not a number");
    assert_eq!(
        message(&text.replace("$Elements", &format!("{nodes}$Elements"))),
        "line 17: the section '$Nodes' is repeated"
    );
    let binary = "$MeshFormat\n2.2 1 8\n\u{1}\0\0\0\n$EndMeshFormat\n$ParametricNodes\n5\n";
    assert!(message(binary).contains("binary parametric nodes are not supported: save the file as text"));
}

#[test]
fn cubes_and_elements_without_a_group() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n\
        7 1 1 1\n8 0 1 1\n$EndNodes\n$Elements\n2\n1 5 0 1 2 3 4 5 6 7 8\n2 3 0 1 4 3 2\n$EndElements\n";
    let mesh = parse(text.as_bytes()).unwrap();
    assert_eq!((mesh.cubes(), mesh.materials().len()), (&[[0, 1, 2, 3, 4, 5, 6, 7]][..], 1));
    assert_eq!((mesh.materials()[0].name.as_str(), mesh.element_material()), ("default", &[0][..]));
    assert_eq!(mesh.surface(), [[0, 3, 2], [0, 2, 1]]);
}

#[test]
fn files_without_elements_are_surfaces() {
    let text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n9 9 9 9\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 0\n$EndNodes\n\
        $Elements\n2\n1 2 0 2 3 4\n2 3 0 5 2 3 4\n$EndElements\n";
    let surface = |text: &str| parse_any(text.as_bytes()).map(|found| found.into_surface().unwrap().0);
    let mesh = surface(text).unwrap();
    assert_eq!(mesh.faces(), [[1, 2, 3], [4, 1, 2], [4, 2, 3]]);
    assert_eq!(mesh.rest_positions().len(), 5);
    assert!(message(text).starts_with("the mesh has no elements: it is a surface of 3 triangles"));
    let higher = text.replace("2 3 0 5 2 3 4\n", "2 16 0 5 2 3 4 9 9 9 9\n");
    let refused = surface(&higher).unwrap_err().to_string();
    assert!(refused.starts_with("line 15: element type 16 is not supported: only triangles"), "{refused}");
    // A solid needs no faces; its surface is that of its elements.
    assert_eq!(
        surface(&V2.replace("2 2 2 1 1 10 20 30", "2 16 2 1 1 10 20 30 40 7 10 10 10"))
            .unwrap()
            .faces()
            .len(),
        6
    );
}

#[test]
fn errors_name_the_line() {
    let v2 = |from, to| message(&V2.replace(from, to));
    let v4 = |from, to| message(&V4.replace(from, to));
    assert_eq!(message("OFF\n"), "line 1: a gmsh file begins with '$MeshFormat', not 'OFF'");
    assert_eq!(
        v2("2.2 0", "4.0 0"),
        "line 2: version '4.0' of the format is not supported: save the file as 2.2 or 4.1"
    );
    assert_eq!(v2("$EndMeshFormat", "$End"), "line 3: '$EndMeshFormat' was expected, not '$End'");
    assert_eq!(v2("\"soft body\"", "soft"), "line 7: a name in double quotes was expected");
    assert_eq!(v2("30 0 1 0", "20 0 1 0"), "line 15: two nodes have the tag 20");
    assert_eq!(v2("30 0 1 0", "30 0 1 nan"), "line 13: 'nan' is not a finite number");
    assert_eq!(
        v2("30 0 1 0", "30 0 1 1e61"),
        "line 13: a coordinate is not finite, or beyond 2^200: repair it, or change the unit"
    );
    assert_eq!(v2("30 0 1 0", "-30 0 1 0"), "line 13: -30 is not a tag");
    assert_eq!(v2("30 40 7\n", "30 40 8\n"), "line 22: the element names node 8, which does not exist");
    assert_eq!(v2("30 40 7\n", "30 40 20\n"), "line 22: the element names node 20 twice");
    assert!(
        v2("4 4 2 6", "4 6 2 6")
            .starts_with("line 22: element type 6 is not supported: solid elements must be tetrahedra of 4")
    );
    // The last tetrahedron alone has ten nodes.
    let mixed = V2.replace("4 4 2 6 1 20 30 40 7", "4 11 2 6 1 20 30 40 7 1 2 3 4 5 6");
    let mixed =
        mixed.replace("$Nodes\n5\n", "$Nodes\n11\n1 0 0 2\n2 0 0 3\n3 0 0 4\n4 0 0 5\n5 0 0 6\n6 0 0 7\n");
    assert!(message(&mixed).starts_with("1 of 2 tetrahedra are of second order"), "{}", message(&mixed));
    assert_eq!(v2("$Elements", "$Other"), "the file ends before '$EndOther'");
    assert_eq!(v2("$EndElements\n", "$EndElements\n$Nodes\n"), "line 24: the section '$Nodes' is repeated");
    for (text, section, line) in [(V2, "PhysicalNames", 19), (V4, "PhysicalNames", 37), (V4, "Entities", 34)]
    {
        let [start, end] = [format!("${section}\n"), format!("$End{section}\n")];
        let (before, rest) = text.split_once(&start).unwrap();
        let (content, after) = rest.split_once(&end).unwrap();
        let cause = format!(
            "line {line}: '${section}' comes after $Elements, which need it for their materials: move it before them"
        );
        assert_eq!(message(&format!("{before}{after}{start}{content}{end}")), cause);
    }
    // The reader skips the entities of version 2.
    check(&parse(format!("{V2}$Entities\nx\n$EndEntities\n").as_bytes()).unwrap());
    assert_eq!(v2("$Elements\n4", "$Elements\n5"), "line 23: '$EndElements' is not an integer");
    assert_eq!(v4("2 5 7 40", "2 6 7 40"), "line 28: the section has 5 nodes, but declares 6");
    assert_eq!(v4("4 4 1 4", "4 5 1 4"), "line 39: the section has 4 elements, but declares 5");
    assert_eq!(v4("2 1 1 3", "2 1 2 3"), "line 17: dimension 2 with parametric 2 is not supported");
    let repeated = v2("4 4 2 6 1 20 30 40 7", "4 4 2 6 1 30 10 20 40");
    assert_eq!(repeated, "tetrahedra 0 and 1 (counted from 0) have the same corners");
    assert!(
        message("$MeshFormat\n4.1 1 4\n\u{1}").contains("numbers of 4 bytes are not supported: only 8 are")
    );
    assert!(message("$MeshFormat\n4.1 1 8\nabcd\n").contains("the byte order is not clear"));
    assert!(message("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n").contains("no section $Elements"));
    assert!(
        message("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Elements\n")
            .contains("$Elements comes before $Nodes")
    );
}

#[test]
fn every_truncation_is_rejected() {
    let files = [
        V2.as_bytes().to_vec(),
        V4.as_bytes().to_vec(),
        binary(Version::V2, false),
        binary(Version::V4, true),
    ];
    for file in files {
        for len in 0..file.len() - 1 {
            assert!(parse(&file[..len]).is_err(), "{len}");
        }
    }
}

#[test]
fn tetrahedra_and_triangles_of_second_order_are_read() {
    let nodes = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n10\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .5 0 0\n\
        6 .5 .5 0\n7 0 .5 0\n8 0 0 .5\n9 0 .5 .5\n10 .5 0 .5\n$EndNodes\n$Elements\n";
    let tet = format!("{nodes}2\n1 9 2 0 1 1 3 2 7 6 5\n2 11 2 0 1 1 2 3 4 5 6 7 8 9 10\n$EndElements\n");
    let mesh = parse(tet.as_bytes()).unwrap();
    assert_eq!((mesh.tets(), mesh.middles()), (&[[0, 1, 2, 3]][..], &[[4, 5, 6, 7, 8, 9]][..]));
    assert_eq!(mesh.surface(), [[0, 2, 1]]);
    let solid = mesh.solid(&sscc_solid::PartialMaterial::default()).unwrap().solid;
    assert!((solid.mass_properties().mass - 1000.0 / 6.0).abs() < 1e-9);
    assert_eq!(mesh.surface_mesh().unwrap().faces(), solid.boundary().unwrap().mesh.faces());
    assert_eq!(solid.boundary().unwrap().mesh.faces().len(), 16);
    let face = format!("{nodes}1\n1 9 2 0 1 1 3 2 7 6 5\n$EndElements\n");
    let (surface, _) = parse_any(face.as_bytes()).unwrap().into_surface().unwrap();
    assert_eq!(surface.faces(), [[0, 6, 4], [6, 2, 5], [4, 5, 1], [6, 5, 4]]);
    assert_eq!(
        message(&tet.replace("8 9 10\n", "8 9 11\n")),
        "line 20: the element names node 11, which does not exist"
    );
}
