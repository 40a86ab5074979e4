//! Tetrahedra of second order: isoparametric, with a node in the middle of each edge, so that edges may be curved.
//!
//! Strains are linear within an element, so it bends as a beam does, where a linear tetrahedron is far too stiff. The nodes are
//! ordered as in gmsh: four corners, then the middles of [`EDGES`].

use glam::DVec3;

use crate::integration_point::{IntegrationPoint, jacobian};

/// Corners of the edge of each middle node.
pub(crate) const EDGES: [[usize; 2]; 6] = [[0, 1], [1, 2], [0, 2], [0, 3], [2, 3], [1, 3]];

/// Jacobian determinant at a node or an integration point, over the cube of the largest distance of a node from the
/// first one. If it is at most this, the element is flat or inverted there.
const MIN_JACOBIAN: f64 = 1e-9;

/// Orbits of four integration points in barycentric coordinates, with the weight of each point. With [`EDGE_ORBIT`], the 14
/// points are exact for polynomials of degree 5 (Walkington 2000); where edges are straight, the mass has degree 4, energies
/// of St. Venant-Kirchhoff have degree 4, too, and the stiffness has degree 2.
const CORNER_ORBITS: [(f64, f64); 2] = [
    (0.310_885_919_263_300_6, 0.112_687_925_718_015_85),
    (0.092_735_250_310_891_23, 0.073_493_043_116_361_95),
];

/// Orbit of six integration points, as [`CORNER_ORBITS`].
const EDGE_ORBIT: (f64, f64) = (0.045_503_704_125_649_65, 0.042_546_020_777_081_47);

/// Returns the middle node of an edge between two corners, from 4.
pub(crate) fn middle(a: usize, b: usize) -> usize {
    4 + EDGES.iter().position(|edge| edge.contains(&a) && edge.contains(&b)).unwrap_or_default()
}

/// Whether at least two middle nodes are nearer to the middle of another edge than to that of their own: then they are in another
/// order, or exchanged.
pub(crate) fn has_exchanged_middles(nodes: &[DVec3; 10]) -> bool {
    let middles = EDGES.map(|[a, b]| 0.5 * nodes[a] + 0.5 * nodes[b]);
    let is_elsewhere = |k: usize| {
        let distance = |edge: usize| nodes[4 + k].distance_squared(middles[edge]);
        (0..6).any(|edge| distance(edge) < distance(k))
    };
    (0..6).filter(|k| is_elsewhere(*k)).count() >= 2
}

/// Returns the integration points of an element.
pub(crate) fn points(nodes: &[DVec3; 10]) -> Vec<IntegrationPoint> {
    // The reference tetrahedron has a volume of a sixth.
    rule()
        .map(|(at, weight)| IntegrationPoint::isoparametric(nodes, &shape(at), &gradients(at), weight / 6.0))
        .collect()
}

/// Whether an element is flat or inverted at a node or an integration point.
pub(crate) fn is_inverted(nodes: &[DVec3; 10]) -> bool {
    let size = nodes.iter().map(|p| p.distance(nodes[0])).fold(0.0, f64::max);
    let corners = (0..4).map(|k| std::array::from_fn(|i| f64::from(u8::from(i == k))));
    let middles = EDGES.map(|edge| std::array::from_fn(|i| if edge.contains(&i) { 0.5 } else { 0.0 }));
    corners.chain(middles).chain(rule().map(|(at, _)| at)).any(|at| {
        let determinant = jacobian(nodes, &gradients(at)).determinant();
        // NaN (an overflow) is inverted, too.
        determinant.is_nan() || determinant <= MIN_JACOBIAN * size * size * size
    })
}

/// Returns barycentric coordinates and weight of each integration point; the weights have the sum 1.
fn rule() -> impl Iterator<Item = ([f64; 4], f64)> {
    let corners = CORNER_ORBITS.into_iter().flat_map(|(a, weight)| {
        (0..4).map(move |k| (std::array::from_fn(|i| if i == k { 1.0 - 3.0 * a } else { a }), weight))
    });
    let (a, weight) = EDGE_ORBIT;
    let edges = EDGES
        .into_iter()
        .map(move |edge| (std::array::from_fn(|i| if edge.contains(&i) { 0.5 - a } else { a }), weight));
    corners.chain(edges)
}

/// Returns the shape functions at barycentric coordinates: `L_i (2 L_i - 1)` and `4 L_i L_j`.
fn shape(at: [f64; 4]) -> [f64; 10] {
    std::array::from_fn(|node| match node {
        0..4 => at[node] * (2.0 * at[node] - 1.0),
        _ => 4.0 * EDGES[node - 4].map(|i| at[i]).iter().product::<f64>(),
    })
}

/// Returns the gradients of the shape functions with respect to the coordinates of the corners 1, 2 and 3.
fn gradients(at: [f64; 4]) -> [DVec3; 10] {
    let of_coordinate = [DVec3::NEG_ONE, DVec3::X, DVec3::Y, DVec3::Z];
    std::array::from_fn(|node| match node {
        0..4 => of_coordinate[node] * (4.0 * at[node] - 1.0),
        _ => {
            let [i, j] = EDGES[node - 4];
            (of_coordinate[i] * at[j] + of_coordinate[j] * at[i]) * 4.0
        }
    })
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;

    /// A tetrahedron with straight edges, or with middles that are moved.
    fn nodes(bend: f64) -> [DVec3; 10] {
        let corners =
            [DVec3::ZERO, DVec3::new(2.0, 0.1, 0.0), DVec3::new(0.3, 1.0, 0.2), DVec3::new(0.1, 0.4, 3.0)];
        std::array::from_fn(|node| match node {
            0..4 => corners[node],
            _ => {
                let [i, j] = EDGES[node - 4];
                let k = node as f64;
                (corners[i] + corners[j]) / 2.0 + DVec3::new(k.sin(), k.cos(), (2.0 * k).sin()) * bend
            }
        })
    }

    #[test]
    fn the_integration_points_are_exact_for_polynomials_of_degree_five() {
        let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
        for powers in
            (0..6).flat_map(|i| (0..6 - i).flat_map(move |j| (0..6 - i - j).map(move |k| [i, j, k])))
        {
            let found: f64 = rule()
                .map(|(at, weight)| weight * (0..3).map(|k| at[k].powi(powers[k])).product::<f64>())
                .sum();
            let exact = 6.0 * powers.map(factorial).iter().product::<f64>()
                / factorial(3 + powers.iter().sum::<i32>());
            assert!((found - exact).abs() < 1e-15, "{powers:?}: {found} {exact}");
        }
    }

    #[test]
    fn linear_fields_have_constant_gradients_in_curved_elements() {
        let map = DMat3::from_cols_array(&[1.0, 2.0, -1.0, 0.5, 3.0, 0.0, 0.2, -0.4, 1.5]);
        for bend in [0.0, 0.03] {
            let nodes = nodes(bend);
            assert!(!is_inverted(&nodes));
            for point in points(&nodes) {
                let mut gradient = DMat3::ZERO;
                for (p, g) in nodes.iter().zip(point.gradients) {
                    let u = map * *p;
                    gradient += DMat3::from_cols(u * g.x, u * g.y, u * g.z);
                }
                assert!(gradient.abs_diff_eq(map, 1e-12), "{gradient} {map}");
                assert!((point.shape.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn elements_are_inverted_where_a_middle_is_far_from_its_edge_or_at_a_corner() {
        let straight = nodes(0.0);
        for moved in [straight[0], straight[1], straight[0] * 0.8 + straight[1] * 0.2, DVec3::splat(9.0)] {
            let mut nodes = straight;
            nodes[4] = moved;
            assert!(is_inverted(&nodes), "{moved}");
        }
        let mut turned = straight;
        turned.swap(0, 1);
        assert!(is_inverted(&turned));
        assert!(is_inverted(&[DVec3::NAN; 10]));
        assert_eq!(middle(3, 1), 9);
    }
}
