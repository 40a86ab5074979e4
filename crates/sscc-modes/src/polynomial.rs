//! Quadratic polynomial modes (paper, section 7; Witkin and Welch 1990).
//!
//! Each component of a displacement is a quadratic polynomial of the rest position: 10 monomials times 3 components give
//! 30 fields. Without the 6 infinitesimal rigid motions, 24 remain. These modes vary smoothly even across narrow gaps, so
//! they cause few self-collisions.
//!
//! The computation uses scalars: the monomials are made orthonormal first, so the quadratic ones, times each axis, are
//! already modes. Only the linear fields need a second, small basis (12 numbers each), which starts with the rigid motions.

use glam::DVec3;
use sscc::parts::vertex_areas;
use sscc::{Modes, TriMesh};

use crate::ModesError;
use crate::orthonormal_basis::OrthonormalBasis;

/// Constant and linear monomials.
const LINEAR: [fn(DVec3) -> f64; 4] = [|_| 1.0, |p| p.x, |p| p.y, |p| p.z];

/// Quadratic monomials.
const QUADRATIC: [fn(DVec3) -> f64; 6] =
    [|p| p.x * p.x, |p| p.y * p.y, |p| p.z * p.z, |p| p.y * p.z, |p| p.z * p.x, |p| p.x * p.y];

/// Linear fields `F p`, rows of F: infinitesimal rotations about x, y, z.
const ROTATIONS: [[DVec3; 3]; 3] = [
    [DVec3::ZERO, DVec3::NEG_Z, DVec3::Y],
    [DVec3::Z, DVec3::ZERO, DVec3::NEG_X],
    [DVec3::NEG_Y, DVec3::X, DVec3::ZERO],
];

/// Linear fields `F p`, rows of F: stretches along x, y, z, then shears in yz, zx, xy.
const STRAINS: [[DVec3; 3]; 6] = [
    [DVec3::X, DVec3::ZERO, DVec3::ZERO],
    [DVec3::ZERO, DVec3::Y, DVec3::ZERO],
    [DVec3::ZERO, DVec3::ZERO, DVec3::Z],
    [DVec3::ZERO, DVec3::Z, DVec3::Y],
    [DVec3::Z, DVec3::ZERO, DVec3::X],
    [DVec3::Y, DVec3::X, DVec3::ZERO],
];

/// Maximum rounding error of positions, relative to their magnitude: 8 roundings.
const POSITION_NOISE: f64 = 4.0 * f64::EPSILON;

/// Computes the displacement fields that are quadratic polynomials of the rest position, without rigid motions, as modes
/// of the mesh. Unused vertices move with the polynomials, too.
///
/// The modes are orthonormal over the surface: `sum_v area_v U_vi . U_vj` is 1 if i = j, else 0, where `area_v` is a
/// third of the area of the triangles at vertex v ([`vertex_areas`]). An entry has the unit 1 / length and q the unit
/// length squared, so a q much smaller than the squared size of the shape is a small deformation. Under the same inner
/// product every mode is orthogonal to the 6 infinitesimal rigid motions; together they span all 30 fields.
///
/// The linear fields come first (stretch along x, y, z, shear in yz, zx, xy), then the monomials xx, yy, zz, yz, zx, xy
/// times each of the three axes. Each is made orthogonal to all before it.
///
/// A general surface has exactly 24 modes. A surface whose vertices satisfy a quadratic equation has fewer independent
/// fields, hence fewer modes: 21 on a sphere, 12 in a plane, 3 for a single triangle.
///
/// # Errors
/// When the surface has no area, is too far from the origin for the rounding of its positions, or a mode entry is out of
/// range (surfaces smaller than about 1e-60, or an unused vertex relatively as far away).
pub fn polynomial_modes(mesh: &TriMesh) -> Result<Modes, ModesError> {
    let Surface { weights, area, points, noise, .. } = Surface::new(mesh)?;
    let values = |monomial: fn(DVec3) -> f64| points.iter().map(|p| monomial(*p)).collect();

    let mut scalars = OrthonormalBasis::new(weights, noise);
    for monomial in LINEAR {
        scalars.add(values(monomial));
    }
    let linear = scalars.vectors().len();
    let strains = strain_fields(&scalars, [1, 2, 3].map(|k| values(LINEAR[k])), noise);
    for monomial in QUADRATIC {
        scalars.add(values(monomial));
    }

    let scale = 1.0 / area.sqrt();
    let scalars = scalars.vectors();
    let rank = strains.len() + 3 * (scalars.len() - linear);
    let mut displacements = Vec::with_capacity(points.len() * rank);
    for v in 0..points.len() {
        for strain in &strains {
            let mut u = DVec3::ZERO;
            for (scalar, coefficients) in scalars.iter().zip(strain) {
                u += *coefficients * scalar[v];
            }
            displacements.push(u * scale);
        }
        for scalar in &scalars[linear..] {
            displacements.extend(DVec3::AXES.map(|axis| axis * (scalar[v] * scale)));
        }
    }
    Ok(Modes::new(rank, displacements)?)
}

/// Surface in coordinates with its centroid at 0 and size 1.
struct Surface {
    /// Share of the area of each vertex; the sum is 1.
    weights: Vec<f64>,
    /// Total area (model unit squared).
    area: f64,
    /// Centred and scaled rest positions: the weighted mean of `|p|^2` is 1.
    points: Vec<DVec3>,
    /// Maximum error of points by rounding of the rest positions.
    noise: f64,
}

impl Surface {
    fn new(mesh: &TriMesh) -> Result<Self, ModesError> {
        let rest = mesh.rest_positions();
        let mut weights = vertex_areas(mesh);
        let area: f64 = weights.iter().sum();
        if area <= 0.0 {
            return Err(ModesError::NoArea);
        }
        weights.iter_mut().for_each(|w| *w /= area);
        // Sums relative to one corner keep the digits of the centroid far from the origin.
        let near = rest[mesh.faces()[0][0] as usize];
        let mut centroid = DVec3::ZERO;
        for (w, p) in weights.iter().zip(rest) {
            centroid += (*p - near) * *w;
        }
        let mut points: Vec<DVec3> = rest.iter().map(|p| (*p - near) - centroid).collect();
        let radius = mean_square(&weights, &points).sqrt();
        let distance = mean_square(&weights, rest).sqrt();
        let noise = POSITION_NOISE * distance / radius;
        if noise.is_nan() || noise >= 0.25 {
            return Err(ModesError::TooFarFromOrigin { radius, distance });
        }
        points.iter_mut().for_each(|p| *p /= radius);
        Ok(Self { weights, area, points, noise })
    }
}

/// Returns the weighted mean of `|p|^2` over the points of positive weight.
fn mean_square(weights: &[f64], points: &[DVec3]) -> f64 {
    weights.iter().zip(points).map(|(w, p)| w * p.length_squared()).sum()
}

/// Returns the linear fields without rigid motions, orthonormal: the vectors `c` of `sum_i c[i] scalar_i` for each field.
/// `scalars` has the constant and the linear scalars, `coordinates` x, y and z.
fn strain_fields(scalars: &OrthonormalBasis, coordinates: [Vec<f64>; 3], noise: f64) -> Vec<Vec<DVec3>> {
    let count = scalars.vectors().len();
    // p = sum_i along[i] scalar_i
    let along: Vec<DVec3> = scalars
        .vectors()
        .iter()
        .map(|e| DVec3::from_array(coordinates.each_ref().map(|x| scalars.dot(e, x))))
        .collect();
    let field = |rows: [DVec3; 3]| along.iter().flat_map(|p| rows.map(|row| row.dot(*p))).collect();

    let mut fields = OrthonormalBasis::new(vec![1.0; 3 * count], noise);
    for axis in 0..3 {
        let mut translation = vec![0.0; 3 * count];
        translation[axis] = 1.0; // scalar 0 is the constant
        fields.add(translation);
    }
    for rotation in ROTATIONS {
        fields.add(field(rotation));
    }
    let rigid = fields.vectors().len();
    for strain in STRAINS {
        fields.add(field(strain));
    }
    let as_vectors = |c: &Vec<f64>| c.chunks_exact(3).map(DVec3::from_slice).collect();
    fields.vectors()[rigid..].iter().map(as_vectors).collect()
}
