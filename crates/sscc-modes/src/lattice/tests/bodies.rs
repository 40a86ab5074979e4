//! Closed surfaces for tests.

use glam::DVec3;
use sscc::TriMesh;

pub fn mesh(positions: Vec<DVec3>, faces: Vec<[u32; 3]>) -> TriMesh {
    TriMesh::new(positions, faces).expect("a test surface is a valid mesh")
}

/// Maps every vertex; faces are unchanged.
pub fn moved(of: &TriMesh, map: impl Fn(DVec3) -> DVec3) -> TriMesh {
    mesh(of.rest_positions().iter().map(|p| map(*p)).collect(), of.faces().to_vec())
}

/// Joins several surfaces.
pub fn joined(parts: &[TriMesh]) -> TriMesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for part in parts {
        let first = positions.len() as u32;
        positions.extend_from_slice(part.rest_positions());
        faces.extend(part.faces().iter().map(|face| face.map(|v| v + first)));
    }
    mesh(positions, faces)
}

/// Reverses all faces.
pub fn inverted(of: &TriMesh) -> TriMesh {
    mesh(of.rest_positions().to_vec(), of.faces().iter().map(|[a, b, c]| [*a, *c, *b]).collect())
}

/// Returns a rod through sections of four corners each, counterclockwise about the axis.
pub fn rod(sections: &[[DVec3; 4]]) -> TriMesh {
    let last = 4 * (sections.len() as u32 - 1);
    let mut faces = vec![[0, 2, 1], [0, 3, 2], [last, last + 1, last + 2], [last, last + 2, last + 3]];
    for first in (0..last).step_by(4) {
        for k in 0..4 {
            let [a, b] = [first + k, first + (k + 1) % 4];
            faces.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    mesh(sections.concat(), faces)
}

/// Returns the box between two corners.
pub fn cuboid(low: DVec3, high: DVec3) -> TriMesh {
    let section = |z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, z);
        [corner(low.x, low.y), corner(high.x, low.y), corner(high.x, high.y), corner(low.x, high.y)]
    };
    rod(&[section(low.z), section(high.z)])
}

/// Returns a ring about the z axis of radii 0.7 and 1 and height 0.3, open by this angle on each side of the x axis.
pub fn cut_ring(gap: f64) -> TriMesh {
    let count = 200;
    let section = |i: u32| {
        let angle = gap + f64::from(i) / f64::from(count) * (std::f64::consts::TAU - 2.0 * gap);
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let corner = |r: f64, z: f64| DVec3::new(r * cos, r * sin, z);
        [corner(0.7, 0.0), corner(0.7, 0.3), corner(1.0, 0.3), corner(1.0, 0.0)]
    };
    rod(&(0..=count).map(section).collect::<Vec<_>>())
}

/// Returns a folded plate of width 1 along y: layers of length 1 along x, `height` apart, 0.4 heights thick.
pub fn folded_plate(layers: i32, height: f64) -> TriMesh {
    let ends = |layer: i32| if layer % 2 == 0 { [0.0, 1.0] } else { [1.0, 0.0] };
    let path: Vec<DVec3> = (0..layers)
        .flat_map(|layer| ends(layer).map(|x| DVec3::new(x, 0.0, height * f64::from(layer))))
        .collect();
    // Half the thickness, across each segment of the path.
    let across: Vec<DVec3> =
        path.windows(2).map(|of| 0.2 * height * (of[1] - of[0]).normalize().cross(DVec3::Y)).collect();
    let section = |i: usize| {
        let mitre = match i {
            0 => across[0],
            i if i == across.len() => across[i - 1],
            i => across[i - 1] + across[i],
        };
        [path[i] - mitre, path[i] - mitre + DVec3::Y, path[i] + mitre + DVec3::Y, path[i] + mitre]
    };
    rod(&(0..path.len()).map(section).collect::<Vec<_>>())
}

/// Returns a cylinder about the x axis, of length 1, radius 1e-5 and a number of sides.
pub fn needle(sides: u32) -> TriMesh {
    let point = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i / 2) / f64::from(sides);
        DVec3::new(f64::from(i % 2), 1e-5 * libm::cos(angle), 1e-5 * libm::sin(angle))
    };
    let [left, right] = [2 * sides, 2 * sides + 1];
    let side = |k: u32| {
        let [a, b] = [2 * k, 2 * ((k + 1) % sides)];
        [[a, b, b + 1], [a, b + 1, a + 1], [left, b, a], [right, a + 1, b + 1]]
    };
    let positions = (0..left).map(point).chain([DVec3::ZERO, DVec3::X]).collect();
    mesh(positions, (0..sides).flat_map(side).collect())
}

/// Returns the unit sphere: a subdivided octahedron.
pub fn sphere(splits: u32) -> TriMesh {
    let mut positions = [DVec3::AXES, DVec3::AXES.map(|p| -p)].concat();
    let mut faces: Vec<[u32; 3]> = Vec::new();
    for octant in 0..8 {
        let corner = |axis: u32| axis + 3 * (octant >> axis & 1);
        let outward = u32::count_ones(octant).is_multiple_of(2);
        let [a, b, c] = [corner(0), corner(1), corner(2)];
        faces.push(if outward { [a, b, c] } else { [a, c, b] });
    }
    for _ in 0..splits {
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                positions.push((positions[a as usize] + positions[b as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        let split = |[a, b, c]: [u32; 3]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    mesh(positions, faces)
}
