//! Scaling matrices M of section 6: how far a deformation is from the centre.

use glam::DVec3;

use crate::{Error, Modes, TriMesh, limits};

/// A metric, given by its factor `S` (diagonal): `M = S'S`, scaled coordinates `z = S q`, scaled modes
/// `A = U S^-1`. The factor itself is the metric: the length of q is `|S q|`, never `sqrt(q'Mq)`, which
/// loses half the digits when weights differ much.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    kind: MetricKind,
    scales: Vec<f64>,
}

/// Where the scales of a [`Metric`] come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricKind {
    /// All weights 1.
    Identity,
    /// Each mode by its largest vertex displacement, so that `|z|` is a length (paper, section 6).
    Displacement,
    /// Each mode by the root of `sum_v area_v |U_v|^2`: how much surface it moves (paper, section 6).
    Mass,
    /// Weights that the caller gave.
    Given,
}

impl MetricKind {
    /// The name used on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identity => "identity",
            Self::Displacement => "displacement",
            Self::Mass => "mass",
            Self::Given => "given",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Identity, Self::Displacement, Self::Mass, Self::Given]
            .into_iter()
            .find(|kind| kind.name() == name)
    }
}

impl Metric {
    /// All weights 1.
    pub fn identity(rank: usize) -> Self {
        Self { kind: MetricKind::Identity, scales: vec![1.0; rank] }
    }

    /// Each mode by its largest displacement of a vertex that some face uses. A mode that moves nothing
    /// gets the smallest scale of the others, or 1.
    pub fn displacement(mesh: &TriMesh, modes: &Modes) -> Self {
        let mut scales = vec![0.0_f64; modes.rank()];
        for v in mesh.used_vertices() {
            for (scale, u) in scales.iter_mut().zip(modes.of_vertex(v)) {
                *scale = scale.max(length(*u));
            }
        }
        Self { kind: MetricKind::Displacement, scales: fill_zeros(scales) }
    }

    /// Each mode by the surface it moves: `sqrt(sum_v area_v |U_v|^2)`, a third of each triangle's area
    /// going to each corner. A mode that moves nothing gets the smallest scale of the others, or 1.
    pub fn mass(mesh: &TriMesh, modes: &Modes) -> Self {
        let areas = vertex_areas(mesh);
        let mut squares = vec![0.0_f64; modes.rank()];
        for v in mesh.used_vertices() {
            for (square, u) in squares.iter_mut().zip(modes.of_vertex(v)) {
                let moved = length(*u);
                *square += areas[v as usize] * moved * moved;
            }
        }
        Self { kind: MetricKind::Mass, scales: fill_zeros(squares.into_iter().map(f64::sqrt).collect()) }
    }

    /// A metric with the given factor: `scales[k]` is the root of the weight of mode k.
    ///
    /// # Errors
    /// When a scale is not positive and finite.
    pub fn from_scales(kind: MetricKind, scales: Vec<f64>) -> Result<Self, Error> {
        if scales.is_empty() {
            return Err(Error::RankZero);
        }
        match scales.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            Some(index) => Err(Error::MetricWeight { index, value: scales[index] }),
            None => Ok(Self { kind, scales }),
        }
    }

    /// A metric with the given weights, the diagonal of `M` (paper, section 4).
    ///
    /// # Errors
    /// When a weight is not positive and finite.
    pub fn from_weights(weights: &[f64]) -> Result<Self, Error> {
        if let Some(index) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(Error::MetricWeight { index, value: weights[index] });
        }
        Self::from_scales(MetricKind::Given, weights.iter().map(|w| w.sqrt()).collect())
    }

    /// Where the scales come from.
    pub fn kind(&self) -> MetricKind {
        self.kind
    }

    /// The diagonal of the factor `S`, one positive number for each mode.
    pub fn scales(&self) -> &[f64] {
        &self.scales
    }

    /// `|S q|`, rounded up: never less than the exact length of the given q. Infinite where it overflows.
    ///
    /// `q` must have one finite entry for each scale (checked by every query before it comes here).
    pub fn norm(&self, q: &[f64]) -> f64 {
        debug_assert_eq!(q.len(), self.scales.len());
        // Squares of numbers in this range neither overflow nor lose anything that counts: the largest
        // is at least 1e-280, and what underflows in the others is at most r 2^-1074.
        const FAST: std::ops::Range<f64> = 1e-140..1e140;
        let mut lanes = [[0.0_f64; 4]; 2];
        let mut scales = self.scales.chunks_exact(4);
        let mut coordinates = q.chunks_exact(4);
        for (s, x) in (&mut scales).zip(&mut coordinates) {
            for i in 0..4 {
                let z = (s[i] * x[i]).abs();
                lanes[0][i] += z * z;
                lanes[1][i] = lanes[1][i].max(z);
            }
        }
        for (s, x) in scales.remainder().iter().zip(coordinates.remainder()) {
            let z = (s * x).abs();
            lanes[0][0] += z * z;
            lanes[1][0] = lanes[1][0].max(z);
        }
        let largest = lanes[1].into_iter().fold(0.0, f64::max);
        let up = 1.0 + (q.len() as f64 + 16.0) * f64::EPSILON;
        if FAST.contains(&largest) {
            let [a, b, c, d] = lanes[0];
            return ((a + b) + (c + d)).sqrt() * up;
        }
        self.norm_scaled(q) * up
    }

    /// The length where squares would overflow or vanish: by the largest component first.
    #[cold]
    fn norm_scaled(&self, q: &[f64]) -> f64 {
        // A product that underflows is rounded up to the smallest normal number: it is not 0.
        let scaled =
            |(s, x): (&f64, &f64)| if *x == 0.0 { 0.0 } else { (s * x).abs().max(f64::MIN_POSITIVE) };
        let largest = self.scales.iter().zip(q).map(scaled).fold(0.0, f64::max);
        if largest == 0.0 || largest == f64::INFINITY {
            return largest;
        }
        let sum: f64 = self.scales.iter().zip(q).map(scaled).map(|z| (z / largest) * (z / largest)).sum();
        largest * sum.sqrt()
    }
}

/// The largest magnitude of an entry of `A = U S^-1` over the used vertices, checked to be 0 or within
/// the range in which the certificates' error terms hold.
///
/// # Errors
/// When the metric has another rank, or the scaled modes are out of range.
pub(crate) fn check_scaled_modes(mesh: &TriMesh, modes: &Modes, metric: &Metric) -> Result<f64, Error> {
    if metric.scales.len() != modes.rank() {
        return Err(Error::MetricLength { found: metric.scales.len(), rank: modes.rank() });
    }
    let mut largest = 0.0_f64;
    let mut moves = false;
    for v in mesh.used_vertices() {
        for (u, s) in modes.of_vertex(v).iter().zip(&metric.scales) {
            largest = largest.max((*u / *s).abs().max_element());
            moves |= *u != DVec3::ZERO;
        }
    }
    // Modes that move something must not vanish when scaled: a radius would become infinite.
    if !moves || (limits::SMALLEST..=limits::LARGEST).contains(&largest) {
        Ok(largest)
    } else {
        Err(Error::MetricRange { largest })
    }
}

/// A third of the area of each face at each of its corners (unit squared), unused vertices 0.
pub fn vertex_areas(mesh: &TriMesh) -> Vec<f64> {
    let p = mesh.rest_positions();
    let mut areas = vec![0.0; p.len()];
    for face in mesh.faces() {
        let [a, b, c] = face.map(|v| p[v as usize]);
        let area = length((b - a).cross(c - a)) / 2.0;
        for &v in face {
            areas[v as usize] += area / 3.0;
        }
    }
    areas
}

/// The length of a vector without overflow or underflow of the squares.
fn length(x: DVec3) -> f64 {
    let largest = x.abs().max_element();
    if largest == 0.0 { 0.0 } else { largest * (x / largest).length() }
}

/// Replaces zero scales (modes that move nothing) by the smallest positive one, or 1.
fn fill_zeros(mut scales: Vec<f64>) -> Vec<f64> {
    let smallest = scales.iter().copied().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let fill = if smallest.is_finite() { smallest } else { 1.0 };
    for scale in scales.iter_mut().filter(|s| **s <= 0.0) {
        *scale = fill;
    }
    scales
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norm_is_never_short() {
        let metric = Metric::from_scales(MetricKind::Given, vec![1e6, 1.0, 1e-6]).unwrap();
        // 1e6 * 3e-6 = 3, 4, 0
        let exact = 5.0;
        let norm = metric.norm(&[3e-6, 4.0, 0.0]);
        assert!(norm >= exact && norm <= exact * (1.0 + 1e-13), "{norm}");
    }

    #[test]
    fn norm_survives_underflow_and_overflow() {
        let metric = Metric::identity(2);
        for x in [1e-170, 5e-324, 1e-308, 1e170, 1e300] {
            let norm = metric.norm(&[x, 0.0]);
            assert!(norm >= x && norm <= x.max(f64::MIN_POSITIVE) * (1.0 + 1e-13), "{x:e}: {norm:e}");
        }
        assert_eq!(metric.norm(&[0.0, 0.0]), 0.0);
        let tiny_scale = Metric::from_scales(MetricKind::Given, vec![1e-200, 1.0]).unwrap();
        assert!(tiny_scale.norm(&[1e-200, 0.0]) > 0.0);
    }
}
