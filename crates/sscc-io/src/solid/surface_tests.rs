//! Surfaces of files with elements and faces, in all formats that list both: no region and no face is lost without a line.

use std::fmt::Write as _;

use sscc::TriMesh;
use sscc_solid::PartialMaterial;

use super::{VolumeOrSurface, gmsh, medit, tetgen, vega, vtk};

/// Elements and faces of a file.
struct Content {
    points: Vec<[f64; 3]>,
    tets: Vec<[usize; 4]>,
    faces: Vec<Vec<usize>>,
}

/// The faces of the tetrahedron of the points 0 to 3.
const FIRST: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

/// A tetrahedron with its listed faces.
fn listed_tet() -> Content {
    Content {
        points: vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]],
        tets: vec![[0, 1, 2, 3]],
        faces: FIRST.map(Vec::from).to_vec(),
    }
}

/// A second tetrahedron pierces the first one. Only the faces of the first one are listed.
fn two_regions() -> Content {
    let mut content = listed_tet();
    content.points.extend([[1.0, 1.0, 1.0], [5.0, 1.0, 1.0], [1.0, 5.0, 1.0], [1.0, 1.0, 5.0]]);
    content.tets.push([4, 5, 6, 7]);
    content
}

/// A triangle of no element pierces a tetrahedron without listed faces.
fn free_triangle() -> Content {
    let mut content = listed_tet();
    content.points.extend([[1.0, 1.0, -1.0], [1.0, 1.0, 1.0], [2.0, 1.0, 1.0]]);
    content.faces = vec![vec![4, 5, 6]];
    content
}

/// A second tetrahedron has a face of the first one, whose faces alone are listed.
fn filling() -> Content {
    let mut content = listed_tet();
    content.points.push([1.0, 1.0, -4.0]);
    content.tets.push([0, 2, 1, 4]);
    content
}

fn joined(numbers: &[usize], first: usize) -> String {
    numbers.iter().map(|number| format!("{} ", number + first)).collect()
}

impl Content {
    /// Returns the elements and faces, each with its type of VTK.
    fn cells(&self) -> Vec<(u8, &[usize])> {
        let tets = self.tets.iter().map(|corners| (10, &corners[..]));
        let faces = self.faces.iter().map(|corners| (if corners.len() == 3 { 5 } else { 9 }, &corners[..]));
        tets.chain(faces).collect()
    }

    fn point_lines(&self) -> String {
        self.points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect()
    }

    fn medit(&self) -> String {
        let mut text = format!("MeshVersionFormatted 1\nDimension 3\nVertices {}\n", self.points.len());
        text += &self.point_lines().replace('\n', " 0\n");
        let section = |name: &str, corners: usize| {
            let of_kind: Vec<_> =
                self.cells().into_iter().filter(|(_, cell)| cell.len() == corners).collect();
            let wanted = of_kind.iter().filter(|(kind, _)| (*kind == 10) == (name == "Tetrahedra"));
            let lines: Vec<String> = wanted.map(|(_, cell)| format!("{} 0\n", joined(cell, 1))).collect();
            format!("{name} {}\n{}", lines.len(), lines.concat())
        };
        text += &section("Tetrahedra", 4);
        text += &section("Triangles", 3);
        text += &section("Quadrilaterals", 4);
        text + "End\n"
    }

    fn gmsh(&self) -> String {
        let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", self.points.len());
        for (number, line) in self.point_lines().lines().enumerate() {
            writeln!(text, "{} {line}", number + 1).unwrap();
        }
        let cells = self.cells();
        writeln!(text, "$EndNodes\n$Elements\n{}", cells.len()).unwrap();
        for (number, (kind, corners)) in cells.into_iter().enumerate() {
            let kind = [(10, 4), (5, 2), (9, 3)].iter().find(|(of_vtk, _)| *of_vtk == kind).unwrap().1;
            writeln!(text, "{} {kind} 0 {}", number + 1, joined(corners, 1)).unwrap();
        }
        text + "$EndElements\n"
    }

    fn vtk(&self) -> String {
        let (cells, points) = (self.cells(), self.point_lines());
        let size: usize = cells.iter().map(|(_, corners)| corners.len() + 1).sum();
        let lines: String =
            cells.iter().map(|(_, corners)| format!("{} {}\n", corners.len(), joined(corners, 0))).collect();
        let types: String = cells.iter().map(|(kind, _)| format!("{kind}\n")).collect();
        format!(
            "# vtk DataFile Version 3.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n{points}\
             CELLS {} {size}\n{lines}CELL_TYPES {}\n{types}",
            self.points.len(),
            cells.len(),
            cells.len()
        )
    }

    fn vtu(&self) -> String {
        let (cells, points) = (self.cells(), self.point_lines());
        let connectivity: String = cells.iter().map(|(_, corners)| joined(corners, 0)).collect();
        let ends = cells.iter().scan(0, |end, (_, corners)| {
            *end += corners.len();
            Some(*end)
        });
        let ends = joined(&ends.collect::<Vec<_>>(), 0);
        let types: String = cells.iter().map(|(kind, _)| format!("{kind} ")).collect();
        format!(
            "<VTKFile type='UnstructuredGrid'><UnstructuredGrid><Piece NumberOfPoints='{}' NumberOfCells='{}'>\
             <Points><DataArray type='Float64' NumberOfComponents='3'>{points}</DataArray></Points><Cells>\
             <DataArray type='Int64' Name='connectivity'>{connectivity}</DataArray>\
             <DataArray type='Int64' Name='offsets'>{ends}</DataArray>\
             <DataArray type='UInt8' Name='types'>{types}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>",
            self.points.len(),
            cells.len()
        )
    }

    /// Returns the content of a file of each format that lists faces beside elements.
    fn read(&self) -> [(&'static str, VolumeOrSurface); 4] {
        [
            ("mesh", medit::parse_any(self.medit().as_bytes())),
            ("msh", gmsh::parse_any(self.gmsh().as_bytes())),
            ("vtk", vtk::parse_any(self.vtk().as_bytes())),
            ("vtu", vtk::parse_any(self.vtu().as_bytes())),
        ]
        .map(|(name, found)| (name, found.unwrap_or_else(|error| panic!("{name}: {error}"))))
    }

    /// Returns the surface and its lines, which are the same in all formats.
    fn surface(&self) -> (TriMesh, Vec<String>) {
        let [first, others @ ..] = self.read().map(|(name, content)| (name, content.into_surface().unwrap()));
        for (name, other) in others {
            assert_eq!(other, first.1, "{name}");
        }
        first.1
    }
}

#[test]
fn regions_whose_faces_are_not_listed_belong_to_the_surface() {
    let (mesh, lines) = two_regions().surface();
    assert_eq!((mesh.faces().len(), mesh.rest_positions().len()), (8, 8));
    assert!(mesh.faces()[4..].as_flattened().iter().all(|vertex| *vertex >= 4));
    assert_eq!(lines, [""; 0]);
    // Formats that list no faces have all regions.
    let points = two_regions().point_lines();
    let numbered: String =
        points.lines().zip(1..).map(|(line, number)| format!("{number} {line}\n")).collect();
    let nodes = tetgen::parse_nodes(format!("8 3 0 0\n{numbered}").as_bytes()).unwrap();
    let of_tetgen = tetgen::parse(&nodes, b"2 4 0\n1 1 2 3 4\n2 5 6 7 8\n").unwrap();
    let vega_text = format!(
        "*VERTICES\n8 3 0 0\n{numbered}*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 5 6 7 8\n*MATERIAL a\nENU, 1, 2, 0.3\n\
         *REGION\nallElements, a\n"
    );
    for solid in [of_tetgen, vega::parse(vega_text.as_bytes()).unwrap()] {
        let (other, lines) = VolumeOrSurface::without_faces(solid).into_surface().unwrap();
        assert_eq!((other.faces(), lines), (mesh.faces(), vec![]));
    }
}

#[test]
fn tetrahedra_outside_the_listed_surface_are_counted() {
    let (mesh, lines) = filling().surface();
    assert_eq!((mesh.faces().len(), mesh.rest_positions().len()), (4, 5));
    assert_eq!(lines, ["1 tetrahedra outside the surface of the file are left out"]);
}

#[test]
fn faces_of_no_element_are_added_to_the_surface() {
    let added = |count: usize| {
        format!(
            "{count} triangles of the file belong to no element: they are added after those of the elements"
        )
    };
    let (mesh, lines) = free_triangle().surface();
    assert_eq!((mesh.faces().len(), mesh.faces()[4], mesh.rest_positions().len()), (5, [4, 5, 6], 7));
    assert_eq!(lines, [added(1)]);
    // Faces of the elements are not added, also if they are listed, in any order of their corners.
    let mut both = free_triangle();
    both.faces.extend(FIRST.map(|[a, b, c]| vec![c, a, b]));
    assert_eq!(both.surface(), (mesh.clone(), lines));
    // A face of a tetrahedron that is left out is one of no element.
    let mut sheet = filling();
    sheet.faces.push(vec![0, 1, 4]);
    let (mesh, lines) = sheet.surface();
    assert_eq!((mesh.faces().len(), mesh.faces()[4]), (5, [0, 1, 4]));
    assert_eq!(lines, ["1 tetrahedra outside the surface of the file are left out".to_owned(), added(1)]);
}

/// The solids for modes have their elements alone; faces that they leave out have a line.
#[test]
fn solids_leave_out_listed_faces_of_no_element() {
    let mut free = filling();
    free.faces = vec![vec![0, 3, 4]];
    assert_eq!(free.surface().0.faces().len(), 7);
    let line =
        "1 triangles of the file belong to no element of the solid: they have no elasticity and are left out";
    for (content, tets, outside, expected) in
        [(two_regions(), 1, 1, &[][..]), (free, 2, 0, &[line]), (filling(), 1, 1, &[])]
    {
        for (name, found) in content.read() {
            let (mesh, lines) = found.into_volume().unwrap();
            let found = mesh.solid(&PartialMaterial::default()).unwrap();
            assert_eq!((found.solid.tets().len(), found.outside), (tets, outside), "{name}");
            assert_eq!(lines, expected, "{name}");
        }
    }
}

#[test]
fn quadrilaterals_of_no_element_are_triangulated_by_their_positions() {
    // The second corner is concave, so the fan around the first one is no triangulation.
    let mut content = listed_tet();
    content.points.extend([[4.0, 0.0, 9.0], [1.0, 1.0, 9.0], [0.0, 4.0, 9.0], [0.0, 0.0, 9.0]]);
    content.faces = vec![vec![4, 5, 6, 7]];
    let (mesh, lines) = content.surface();
    assert_eq!((mesh.faces().len(), lines.len()), (6, 1));
    assert!(
        mesh.faces()[4..].iter().all(|face| face.contains(&5) && face.contains(&7)),
        "{:?}",
        mesh.faces()
    );
    // A quadrilateral that is not plane has a line of its own.
    content.points[7][2] = 12.0;
    let (_, lines) = content.surface();
    let start =
        "of the faces that belong to no element, 1 of the 1 faces with more than 3 corners are not plane";
    assert!(lines.len() == 2 && lines[1].starts_with(start), "{lines:?}");
}

#[test]
fn quadrilaterals_on_two_tetrahedra_belong_to_them_by_either_diagonal() {
    let mut content = Content {
        points: vec![
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.5, 0.5, 1.0],
            [0.0, 0.0, 3.0],
            [1.0, 0.0, 3.0],
            [0.0, 1.0, 3.0],
        ],
        tets: vec![[0, 1, 2, 4], [0, 2, 3, 4]],
        faces: vec![vec![0, 1, 2, 3]],
    };
    for corners in [[0, 1, 2, 3], [1, 2, 3, 0], [3, 2, 1, 0]] {
        content.faces = vec![corners.to_vec()];
        let (mesh, lines) = content.surface();
        assert_eq!((mesh.faces().len(), lines), (6, vec![]), "{corners:?}");
    }
    // Others are still found beside these.
    content.faces = vec![vec![1, 2, 3, 0], vec![5, 6, 7], vec![0, 1, 6, 5], vec![2, 3, 0, 1]];
    let (mesh, lines) = content.surface();
    assert_eq!((mesh.faces().len(), lines.len()), (9, 1));
    assert_eq!(mesh.faces()[6], [5, 6, 7]);
    assert!(mesh.faces()[7..].iter().all(|face| face.iter().all(|v| [0, 1, 6, 5].contains(v))));
}

#[test]
fn curved_triangles_of_no_element_keep_their_middles() {
    let mut content = free_triangle();
    content.points.extend([[1.0, 1.0, 0.1], [1.5, 1.0, 1.0], [1.5, 1.0, 0.2]]);
    let nodes = "4 5 6 7 8 9 ";
    let vtu = content.vtu().replace("4 5 6 ", nodes).replace("4 7 <", "4 10 <").replace("10 5 <", "10 22 <");
    let (mesh, lines) = vtk::parse_any(vtu.as_bytes()).unwrap().into_surface().unwrap();
    assert_eq!(mesh.faces()[4..], [[4, 7, 9], [7, 5, 8], [9, 8, 6], [7, 8, 9]]);
    assert!(lines[0].starts_with("4 triangles of the file belong to no element"), "{lines:?}");
    let gmsh = content.gmsh().replace("2 2 0 5 6 7 ", "2 9 0 5 6 7 8 9 10 ");
    let of_gmsh = gmsh::parse_any(gmsh.as_bytes()).unwrap();
    let (_, left_out) = of_gmsh.clone().into_volume().unwrap();
    assert!(left_out[0].starts_with("4 triangles of the file belong to no element"), "{left_out:?}");
    assert_eq!(of_gmsh.into_surface().unwrap(), (mesh, lines));
}

/// A curved face on a tetrahedron of four nodes.
#[test]
fn faces_whose_middles_are_not_those_of_their_element_have_a_line() {
    let mut content = listed_tet();
    content.points.extend([[1.0, 1.0, 0.1], [1.5, 1.0, 1.0], [1.5, 1.0, 0.2]]);
    let found = |face: &str| {
        let gmsh = content.gmsh().replace("2 2 0 1 2 3 ", face);
        gmsh::parse_any(gmsh.as_bytes()).unwrap().into_surface().unwrap()
    };
    let (mesh, lines) = found("2 2 0 1 2 3 ");
    assert_eq!((mesh.faces().len(), lines.len()), (4, 0));
    let expected = "1 faces of 6 nodes have the corners of faces of elements, but other nodes between them: their own nodes \
                    are left out";
    assert_eq!(found("2 9 0 1 2 3 5 6 7 "), (mesh, vec![expected.to_owned()]));
    // Faces of a tetrahedron of ten nodes, whose middles are its own or others.
    content.points.truncate(4);
    content.points.extend([[2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]]);
    content.points.extend([[0.0, 0.0, 2.0], [0.0, 2.0, 2.0], [2.0, 0.0, 2.0]]);
    for (middles, count) in [("5 6 7", 0), ("5 6 8", 1)] {
        let gmsh = content.gmsh().replace("1 4 0 1 2 3 4 ", "1 11 0 1 2 3 4 5 6 7 8 9 10 ");
        let gmsh = gmsh.replace("2 2 0 1 2 3 ", &format!("2 9 0 1 2 3 {middles} "));
        let (mesh, lines) = gmsh::parse_any(gmsh.as_bytes()).unwrap().into_surface().unwrap();
        assert_eq!((mesh.faces().len(), lines.len()), (16, count), "{lines:?}");
    }
}

#[test]
fn faces_of_a_kind_that_is_not_read_are_named() {
    let cause = "is not supported: only triangles and quadrilaterals of first order are, and triangles of 6 nodes in files of \
                 gmsh and VTK; such faces are left out";
    let medit = listed_tet().medit().replace("End\n", "TrianglesP2 1\n1 2 3 4 1 2 0\nEnd\n");
    let gmsh = listed_tet().gmsh().replace("2 2 0 1 2 3 ", "2 16 0 1 2 3 4 1 2 3 4 ");
    let vtk = free_triangle().vtk().replace("\n5\n", "\n34\n");
    let vtu = free_triangle().vtu().replace("10 5 <", "10 34 <");
    for (kind, place, found) in [
        ("'TrianglesP2'", "line ", medit::parse_any(medit.as_bytes())),
        ("element type 16", "line ", gmsh::parse_any(gmsh.as_bytes())),
        ("cell type 34", "cell 1 (counted from 0): ", vtk::parse_any(vtk.as_bytes())),
        ("cell type 34", "cell 1 (counted from 0): ", vtk::parse_any(vtu.as_bytes())),
    ] {
        let (mesh, lines) = found.unwrap().into_surface().unwrap();
        assert_eq!((mesh.faces().len(), lines.len()), (4, 1), "{kind}");
        assert!(
            lines[0].starts_with(place) && lines[0].ends_with(&format!("{kind} {cause}")),
            "{}",
            lines[0]
        );
    }
}
