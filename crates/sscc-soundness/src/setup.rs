//! A model for the core, its certificates, and the oracle for the same pairs.

use sscc::glam::DVec3;
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Error, Metric, MetricKind, Modes, Neighbours, ReducedModel,
    TriMesh,
};

use crate::exact::Point;
use crate::models::{Extremes, Model};
use crate::oracle::{Bounds, Oracle};
use crate::random::Random;
use crate::tally::Tally;

/// Requirements of a path on its models.
#[derive(Clone, Copy, Debug)]
pub struct Wanted {
    /// Approximate number of triangles.
    pub triangles: usize,
    /// Range of lengths of models.
    pub extremes: Extremes,
    /// Whether certificates have a centre other than the rest pose.
    pub has_center: bool,
    /// Whether the metric is dense.
    pub is_dense: bool,
}

/// A model, its certificates and its oracle.
pub struct Setup {
    /// The model as plain numbers.
    pub model: Model,
    /// The model for the core.
    pub reduced: ReducedModel,
    /// Certificates of the model.
    pub certificates: Certificates,
    /// Oracle for the colliding pairs.
    pub oracle: Oracle,
    /// The largest side of the box at rest.
    pub size: f64,
}

/// Returns the mesh for the core.
pub fn mesh_of(model: &Model) -> Result<TriMesh, Error> {
    TriMesh::new(model.points.iter().map(|p| DVec3::from_array(*p)).collect(), model.faces.clone())
}

fn reduced_of(model: &Model) -> Result<ReducedModel, Error> {
    let modes = Modes::new(model.rank, model.modes.iter().map(|u| DVec3::from_array(*u)).collect())?;
    ReducedModel::new(mesh_of(model)?, modes)
}

/// Returns a triangular factor S with a condition up to 1e7, so that the condition of `M = S'S` is up to 1e14.
fn dense_factor(random: &mut Random, scales: &[f64]) -> Vec<f64> {
    let rank = scales.len();
    let condition = random.power(0.0, 7.0);
    let skew = random.power(-2.0, 0.3);
    let mut factor = vec![0.0; rank * rank];
    for i in 0..rank {
        let size = condition.powf(-random.unit());
        for j in i..rank {
            let entry = if i == j { 1.0 } else { skew * random.signed() };
            factor[i * rank + j] = size * entry * scales[j];
        }
    }
    factor
}

fn metric(random: &mut Random, model: &ReducedModel, is_dense: bool) -> Result<Option<Metric>, Error> {
    let rank = model.rank();
    let scales = Metric::displacement(model.mesh(), model.modes())?.scales();
    if is_dense {
        return Metric::from_factor(MetricKind::Given, rank, dense_factor(random, &scales)).map(Some);
    }
    Ok(match random.below(8) {
        0 => Some(Metric::identity(rank)),
        1 => Some(Metric::mass(model.mesh(), model.modes())?),
        2 | 3 => {
            let scales = scales.iter().map(|s| s * random.power(-2.0, 2.0)).collect();
            Some(Metric::from_scales(MetricKind::Given, scales)?)
        }
        _ => None,
    })
}

impl Setup {
    /// Draws a model and computes its certificates.
    ///
    /// # Errors
    /// The error of the core if it refuses the model.
    pub fn random(random: &mut Random, wanted: &Wanted) -> Result<Self, Error> {
        let model = Model::random(random, wanted.triangles, wanted.extremes);
        let reduced = reduced_of(&model)?;
        let size = Bounds::of(&model.points).size();
        let center = if wanted.has_center { Some(shift(random, &model, size)) } else { None };
        let with_one_vertex = random.one_in(3);
        let neighbours = if with_one_vertex { Neighbours::IncludeOneVertex } else { Neighbours::Exclude };
        let (weld, ignore_rest) = (!random.one_in(6), random.one_in(6));
        let options = CertifyOptions::default()
            .metric(metric(random, &reduced, wanted.is_dense)?)
            .center(center)
            .filter(ContactFilter::new(neighbours).weld(weld))
            .ignore_rest(ignore_rest.then_some(0))
            .max_exceptions(random.one_in(8).then_some(0))
            .budget(random.of(&[0, 64, 64, 512]))
            .local_budget(random.of(&[0, 64, 64, 1 << 14]))
            .epsilon(random.of(&[0.1, 0.5, 0.9]))
            .reach(random.of(&[1.0, 1.0, 8.0]))
            .threads(1);
        let certificates = Certificates::compute(&reduced, &options, &())?;
        let mut oracle = Oracle::new(&model.faces, model.points.len(), with_one_vertex);
        if weld {
            oracle = oracle.welded(&model.points, &model.modes);
        }
        if ignore_rest {
            oracle = oracle.ignoring_at(&model.points);
        }
        Ok(Self { model, reduced, certificates, oracle, size })
    }

    /// Returns the size of a configuration, as a share of the full size. It is small if many triangles collide at the centre.
    pub fn share(&self) -> f64 {
        let colliding = self.oracle.pairs(&self.model.positions(self.certificates.center())).len();
        match colliding {
            0..40 => 1.0,
            40..400 => 0.2,
            _ => 0.02,
        }
    }

    /// Returns a random q, with a random norm or a random displacement of vertices.
    pub fn draw(&self, random: &mut Random) -> Vec<f64> {
        let center = self.certificates.center();
        let y = direction(random, &self.model);
        let at = |scale: f64| -> Vec<f64> { center.iter().zip(&y).map(|(c, y)| c + scale * y).collect() };
        let moved = reach(&self.model, &y);
        let by_length = self.size * random.power(-3.0, 0.3) / moved;
        let unit = self.certificates.norm(&at(by_length)).unwrap_or(0.0) / by_length;
        let root = self.certificates.root_radius();
        let by_norm = root / unit * random.power(0.0, 1.3);
        let scale = match random.below(8) {
            // The norm is the root's radius, up to a few units in the last place.
            0 => root / unit * (1.0 + f64::EPSILON * random.whole(8)),
            1..4 => by_norm,
            4 => self.certificates.global_radius() / unit * random.power(-0.3, 0.5),
            _ => by_length,
        };
        let is_possible = scale > 0.0 && (scale * moved).is_finite() && scale * moved < 1e4 * self.size;
        let scale = if is_possible { scale } else { by_length };
        if scale.is_finite() { at(scale) } else { center.to_vec() }
    }

    /// Whether the core may refuse this q because it moves some vertex beyond its limits.
    pub fn is_beyond_range(&self, q: &[f64]) -> bool {
        let modes = self.model.modes.chunks(self.model.rank);
        let reach = modes.zip(&self.model.points).flat_map(|(modes, p)| {
            (0..3).map(move |c| p[c].abs() + modes.iter().zip(q).map(|(u, q)| (u[c] * q).abs()).sum::<f64>())
        });
        let largest = reach.fold(0.0, |m: f64, x| if x.is_nan() { f64::INFINITY } else { m.max(x) });
        largest > 0.5 * sscc::limits::LARGEST || q.iter().any(|x| !x.is_finite())
    }

    /// Counts a refusal, which is wrong if all these q are within range.
    pub fn refused(&self, tally: &mut Tally, q: &[&[f64]], error: &Error) {
        tally.reach("refused q");
        if !q.iter().any(|q| self.is_beyond_range(q)) {
            tally.wrong(|| format!("{}: q={q:?}: {error}", self.model.name));
        }
    }
}

/// Returns a direction in q-space: of all modes, of a few, of one, or of modes that nearly cancel.
pub fn direction(random: &mut Random, model: &Model) -> Vec<f64> {
    let mut y: Vec<f64> = vec![0.0; model.rank];
    let scale = |k: usize| -> f64 {
        let largest =
            model.modes.iter().skip(k).step_by(model.rank).flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        if largest > 0.0 { 1.0 / largest } else { 1.0 }
    };
    match random.below(6) {
        0 => {
            let k = random.below(model.rank);
            y[k] = random.of(&[-1.0, 1.0]) * scale(k);
        }
        1 if !model.twins.is_empty() => {
            for _ in 0..1 + random.below(3) {
                let (i, j) = random.of(&model.twins);
                let weight = random.normal() * scale(i) * random.power(0.0, 8.0);
                y[i] += weight;
                y[j] -= weight;
            }
        }
        2 => (0..3).for_each(|_| {
            let k = random.below(model.rank);
            y[k] += random.normal() * scale(k);
        }),
        _ => (0..model.rank).for_each(|k| y[k] = random.normal() * scale(k)),
    }
    y
}

/// Returns the largest displacement of a vertex along a direction, approximately; 1 if no vertex moves.
fn reach(model: &Model, y: &[f64]) -> f64 {
    let displacement = |modes: &[Point]| -> f64 {
        (0..3).map(|c| modes.iter().zip(y).map(|(u, y)| u[c] * y).sum::<f64>().abs()).fold(0.0, f64::max)
    };
    let largest = model.modes.chunks(model.rank).map(displacement).fold(0.0, f64::max);
    if largest > 0.0 { largest } else { 1.0 }
}

/// Returns a centre that moves vertices by a small share of the model's size.
fn shift(random: &mut Random, model: &Model, size: f64) -> Vec<f64> {
    let y = direction(random, model);
    let scale = size * random.power(-4.0, -1.3) / reach(model, &y);
    if scale.is_finite() { y.iter().map(|y| y * scale).collect() } else { vec![0.0; model.rank] }
}
