//! Scaling matrices M of section 6: how far a deformation is from the centre.

mod norm;
mod triangular;

use glam::DVec3;

use crate::{Error, Modes, TriMesh, limits};
use triangular::Triangular;

/// A metric, given by its factor `S`, diagonal or upper triangular: `M = S'S`, scaled coordinates `z = S q`,
/// scaled modes `A = U S^-1`. The factor itself is the metric: the length of q is `|S q|`, never `sqrt(q'Mq)`,
/// which loses half the digits when weights differ much.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    kind: MetricKind,
    factor: Factor,
}

#[derive(Clone, Debug, PartialEq)]
enum Factor {
    Diagonal(Vec<f64>),
    Triangular(Triangular),
}

/// Where the factor of a [`Metric`] comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricKind {
    /// All weights 1.
    Identity,
    /// Each mode by its largest vertex displacement, so that `|z|` is a length (paper, section 6).
    Displacement,
    /// Each mode by the root of `sum_v area_v |U_v|^2`: how much surface it moves (paper, section 6).
    Mass,
    /// Each mode by the strain energy that it stores (paper, section 6).
    Energy,
    /// Weights or a matrix that the caller gave.
    Given,
}

impl MetricKind {
    /// The name used on the command line and in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Identity => "identity",
            Self::Displacement => "displacement",
            Self::Mass => "mass",
            Self::Energy => "energy",
            Self::Given => "given",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        [Self::Identity, Self::Displacement, Self::Mass, Self::Energy, Self::Given]
            .into_iter()
            .find(|kind| kind.name() == name)
    }
}

impl Metric {
    /// All weights 1.
    pub fn identity(rank: usize) -> Self {
        Self::diagonal(MetricKind::Identity, vec![1.0; rank])
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
        Self::diagonal(MetricKind::Displacement, fill_zeros(scales))
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
        Self::diagonal(MetricKind::Mass, fill_zeros(squares.into_iter().map(f64::sqrt).collect()))
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
            None => Ok(Self::diagonal(kind, scales)),
        }
    }

    /// A metric with the given weights, the diagonal of `M` (paper, section 4).
    ///
    /// # Errors
    /// When a weight is not positive and finite.
    pub fn from_weights(kind: MetricKind, weights: &[f64]) -> Result<Self, Error> {
        if let Some(index) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(Error::MetricWeight { index, value: weights[index] });
        }
        Self::from_scales(kind, weights.iter().map(|w| w.sqrt()).collect())
    }

    /// A metric with the given dense matrix `M` (r x r, by rows): its factor is Cholesky's.
    ///
    /// # Errors
    /// When M is not square, not symmetric up to rounding (1e-9) or not positive definite, or as
    /// [`Metric::from_factor`].
    pub fn from_matrix(kind: MetricKind, rank: usize, matrix: &[f64]) -> Result<Self, Error> {
        let factor = Factor::Triangular(Triangular::cholesky(rank, matrix)?);
        Ok(Self { kind, factor })
    }

    /// A metric with the given upper triangular factor `S` (r x r, by rows, zeros below the diagonal).
    ///
    /// # Errors
    /// When there are more than 1024 modes, the factor is not square or not upper triangular, an entry is beyond
    /// 2^200, a diagonal entry is not positive or below 2^-200, or the factor is nearly singular (condition beyond
    /// about 1e13, its square for M).
    pub fn from_factor(kind: MetricKind, rank: usize, factor: Vec<f64>) -> Result<Self, Error> {
        Ok(Self { kind, factor: Factor::Triangular(Triangular::new(rank, factor)?) })
    }

    fn diagonal(kind: MetricKind, scales: Vec<f64>) -> Self {
        Self { kind, factor: Factor::Diagonal(scales) }
    }

    /// Where the factor comes from.
    pub fn kind(&self) -> MetricKind {
        self.kind
    }

    /// Number of modes r.
    pub fn rank(&self) -> usize {
        match &self.factor {
            Factor::Diagonal(scales) => scales.len(),
            Factor::Triangular(factor) => factor.rank(),
        }
    }

    /// The diagonal of the factor `S`, one positive number for each mode.
    pub fn scales(&self) -> Vec<f64> {
        match &self.factor {
            Factor::Diagonal(scales) => scales.clone(),
            Factor::Triangular(factor) => factor.diagonal().collect(),
        }
    }

    /// The factor `S` of a dense metric (r x r, by rows); none where it is diagonal.
    pub fn dense_factor(&self) -> Option<&[f64]> {
        match &self.factor {
            Factor::Diagonal(_) => None,
            Factor::Triangular(factor) => Some(factor.entries()),
        }
    }

    /// Refuses modes with which this metric proves nothing.
    ///
    /// # Errors
    /// When it is of another rank, or the modes divided by its factor leave the range in which the proofs hold.
    pub fn check(&self, mesh: &TriMesh, modes: &Modes) -> Result<(), Error> {
        check_scaled_modes(mesh, modes, self).map(|_| ())
    }

    /// `q = S^-1 z`, in plain rounding.
    pub fn unscaled(&self, z: &[f64]) -> Vec<f64> {
        match &self.factor {
            Factor::Diagonal(scales) => z.iter().zip(scales).map(|(z, s)| z / s).collect(),
            Factor::Triangular(factor) => factor.solve(z),
        }
    }

    /// The scaled modes of one vertex, `A = U S^-1`: one vector for each mode, written to `out`. Errors are within
    /// `gamma_r |A||S||S^-1|`.
    pub(crate) fn scaled_modes(&self, modes: &[DVec3], out: &mut [DVec3]) {
        match &self.factor {
            Factor::Diagonal(scales) => {
                out.iter_mut().zip(modes).zip(scales).for_each(|((a, u), s)| *a = *u / *s);
            }
            Factor::Triangular(factor) => factor.divide(modes, out),
        }
    }

    /// What rounding acts upon: `|A||S||S^-1|` from above, for the rows of scaled modes; `|A|` itself where the factor
    /// is diagonal. Errors of positions at z are at most `gamma` times this times `|z|`, component by component.
    pub(crate) fn magnitudes(&self, scaled: &[DVec3], out: &mut [DVec3]) {
        match &self.factor {
            Factor::Diagonal(_) => out.iter_mut().zip(scaled).for_each(|(m, a)| *m = a.abs()),
            Factor::Triangular(factor) => right_or!(
                factor.magnitudes(scaled, out),
                DenseRateOfModesAlone,
                out.iter_mut().zip(scaled).for_each(|(m, a)| *m = a.abs()),
            ),
        }
    }

    /// `|S e_k|`, nearly: how long a unit of mode k is.
    pub(crate) fn mode_length(&self, k: usize) -> f64 {
        match &self.factor {
            Factor::Diagonal(scales) => scales[k],
            Factor::Triangular(factor) => factor.column_length(k),
        }
    }
}

/// The largest magnitude of an entry of `A = U S^-1` over the used vertices, checked to be 0 or within
/// the range in which the certificates' error terms hold.
///
/// # Errors
/// When the metric has another rank, or the scaled modes are out of range.
pub(crate) fn check_scaled_modes(mesh: &TriMesh, modes: &Modes, metric: &Metric) -> Result<f64, Error> {
    if metric.rank() != modes.rank() {
        return Err(Error::MetricLength { found: metric.rank(), rank: modes.rank() });
    }
    let mut largest = 0.0_f64;
    let mut moves = false;
    let mut scaled = vec![DVec3::ZERO; modes.rank()];
    for v in mesh.used_vertices() {
        let of_vertex = modes.of_vertex(v);
        metric.scaled_modes(of_vertex, &mut scaled);
        for (u, a) in of_vertex.iter().zip(&scaled) {
            // A sum that overflows may be no number at all.
            let reach = if a.is_nan() { f64::INFINITY } else { a.abs().max_element() };
            largest = largest.max(reach);
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
