//! Compares the answers of certified queries (discrete ones with and without the pair tree), the traditional method and
//! brute force, for discrete and continuous queries.

use super::claims::Claims;
use super::minimum_search::MinimumSearch;
use super::options::AuditOptions;
use super::random::Random;
use crate::certificates::PairTree;
use crate::{Certificates, Error, Impact, Method, Pair, Progress, Query, ReducedModel};

/// Brute force is quadratic: it runs for every sample of models with at most this many triangles, and for three samples of larger
/// models.
pub(super) const BRUTE_FORCE_TRIANGLES: usize = 2000;

/// One comparison is made for this many samples.
pub(super) const SAMPLES_PER_COMPARISON: usize = 50;

/// At most this many comparisons are made.
pub(super) const MAX_COMPARISONS: usize = 200;

/// One in this many comparisons also compares continuous queries.
const CONTINUOUS: usize = 2;

/// The share of a radius at which configurations just inside it lie.
const INSIDE: f64 = 1.0 - 1e-13;

pub(super) struct Comparison<'a> {
    pub(super) model: &'a ReducedModel,
    pub(super) certificates: &'a Certificates,
    pub(super) claims: &'a Claims<'a>,
    pub(super) minimum: &'a MinimumSearch<'a>,
    pub(super) options: &'a AuditOptions,
    pub(super) progress: &'a dyn Progress,
}

/// The start and the end of a continuous query.
struct Motion {
    q_t0: Vec<f64>,
    q_t1: Vec<f64>,
}

impl Comparison<'_> {
    /// Returns a line for each q or motion at which two methods differ, and for each q at which a collision refutes a
    /// claim.
    pub(super) fn run(&self) -> Result<Vec<String>, Error> {
        let Self { model, certificates, claims, options, .. } = *self;
        let query = |method| Query::with_method(model, certificates, method);
        let (mut certified, mut traditional) = (query(Method::Certified)?, query(Method::Traditional)?);
        let mut brute_force = query(Method::BruteForce)?;
        let mut parts = certificates.parts().clone();
        parts.pair_tree = PairTree::default();
        let without_tree = Certificates::try_from(parts)?;
        let mut nodes_alone = Query::with_method(model, &without_tree, Method::Certified)?;
        let is_small = model.mesh().faces().len() <= BRUTE_FORCE_TRIANGLES;
        let mut violations = Vec::new();
        let comparisons = (options.samples / SAMPLES_PER_COMPARISON).clamp(1, MAX_COMPARISONS);
        for sample in 0..comparisons {
            if self.progress.is_cancelled() {
                break;
            }
            let mut random = Random::new(options.seed, 2_000_000 + sample as u64);
            let q = self.draw_configuration(&mut random, sample);
            let expected = traditional.discrete(&q)?.to_vec();
            let norm = traditional.norm();
            if certified.discrete(&q)? != expected {
                violations.push(format!("certified and traditional answers differ at q = {q:?}"));
            }
            if nodes_alone.discrete(&q)? != expected {
                violations.push(format!(
                    "certified answers without the pair tree and traditional answers differ at q = {q:?}"
                ));
            }
            let has_brute_force = is_small || sample * 3 / comparisons != (sample + 1) * 3 / comparisons;
            if has_brute_force && brute_force.discrete(&q)? != expected {
                violations.push(format!("traditional and brute-force answers differ at q = {q:?}"));
            }
            let is_claimed = |pair: &Pair| certificates.exceptions().binary_search(pair).is_err();
            let mut collisions = expected.into_iter().filter(is_claimed);
            violations.extend(collisions.find_map(|faces| claims.violation(faces, norm, &q)));
            if sample.is_multiple_of(CONTINUOUS) {
                let motion = self.draw_motion(&mut random, sample);
                let expected = traditional.continuous(&motion.q_t0, &motion.q_t1)?.to_vec();
                let mut compare = |query: &mut Query, methods: &str| -> Result<(), Error> {
                    let found = query.continuous(&motion.q_t0, &motion.q_t1)?;
                    violations.extend(self.missed(&expected, found, &motion).map(|missed| {
                        format!(
                            "triangles {} and {} collide at an end of the motion from q = {:?} to {:?}, but only one of \
                             the {methods} answers lists them",
                            missed.0, missed.1, motion.q_t0, motion.q_t1
                        )
                    }));
                    Ok(())
                };
                compare(&mut certified, "certified and traditional")?;
                if has_brute_force && is_small {
                    compare(&mut brute_force, "traditional and brute-force")?;
                }
            }
        }
        Ok(violations)
    }

    /// Returns a pair that only one answer lists although it collides at the start or the end of the motion. Methods may differ
    /// in pairs that only come close. Between start and end, rounding moves the computed shape off the straight line,
    /// so an exact test there proves nothing.
    fn missed(&self, a: &[Impact], b: &[Impact], motion: &Motion) -> Option<Pair> {
        let lacks = |all: &[Impact], impact: &Impact| {
            all.binary_search_by_key(&impact.pair, |other| other.pair).is_err()
        };
        let mut only = a.iter().filter(|i| lacks(b, i)).chain(b.iter().filter(|i| lacks(a, i)));
        let collides = |q: &[f64], pair: Pair| self.minimum.collides(pair, q);
        let missed = only.find(|i| collides(&motion.q_t0, i.pair) || collides(&motion.q_t1, i.pair));
        missed.map(|impact| impact.pair)
    }

    /// Returns a random q whose norm is between a fifth of a radius and five times this radius: that of the root, or a
    /// 25th of the global radius if the root's is 0, or 1 if it is infinite. For every third sample the norm is at most
    /// the limit of the pair tree, if that is positive and the radius finite.
    pub(super) fn draw_configuration(&self, random: &mut Random, sample: usize) -> Vec<f64> {
        let certificates = self.certificates;
        let z = draw_scaled(certificates.center().len(), random, sample);
        let (root, global) = (certificates.root_radius(), certificates.global_radius());
        let limit = certificates.parts().pair_tree.limit();
        let radius = if root > 0.0 { root } else { global / 25.0 };
        let share = random.uniform() * random.uniform();
        let goal = match radius.is_finite() {
            true if sample % 3 == 2 && limit > 0.0 => limit * (1.0 - share * share),
            true => radius * (0.2 + 4.8 * share),
            false => 0.2 + 4.8 * share,
        };
        self.scale_to(&z, goal)
    }

    /// Returns two random q: for every other motion both just inside one radius, else those of
    /// [`Self::draw_configuration`].
    fn draw_motion(&self, random: &mut Random, sample: usize) -> Motion {
        if sample.is_multiple_of(2 * CONTINUOUS) {
            let q_t0 = self.draw_configuration(random, sample);
            return Motion { q_t0, q_t1: self.draw_configuration(random, sample) };
        }
        let (certificates, claims) = (self.certificates, self.claims);
        let nodes = certificates.hierarchy().nodes().len();
        let radius = match random.below(3) {
            0 => certificates.root_radius(),
            1 => claims
                .random_pair(random, sample.is_multiple_of(4 * CONTINUOUS))
                .map_or(0.0, |claim| claim.radius),
            _ => claims.node(random.below(nodes) as u32).radius,
        };
        let goal = if radius.is_finite() { radius * INSIDE } else { 1.0 };
        let mut draw = || self.scale_to(&draw_scaled(certificates.center().len(), random, sample), goal);
        Motion { q_t0: draw(), q_t1: draw() }
    }

    /// Returns the q in the direction of z with a norm of about `goal`.
    fn scale_to(&self, z: &[f64], goal: f64) -> Vec<f64> {
        let norm = z.iter().map(|z| z * z).sum::<f64>().sqrt();
        self.certificates.parts().scope.at(z, if norm > 0.0 { goal / norm } else { 0.0 })
    }
}

/// Returns a random z. The number of the sample decides how fast the entries of z decrease with the mode.
fn draw_scaled(rank: usize, random: &mut Random, sample: usize) -> Vec<f64> {
    let weight = |k: usize| (1.0 + k as f64).powi(sample as i32 % 3);
    random.normals(rank).iter().enumerate().map(|(k, z)| z / weight(k)).collect()
}
