//! Answers of certified queries, with the pair tree and without, against the traditional method, and that against
//! brute force; at single q, and on the way between two.

use super::AuditOptions;
use super::claims::Claims;
use super::minimum::Minimum;
use super::random::Random;
use crate::{Certificates, Error, Impact, Method, Pair, PairTree, Progress, Query, ReducedModel};

/// Brute force is quadratic: up to this many triangles for every sample, beyond for three of them.
const BRUTE_FORCE_TRIANGLES: usize = 2000;

/// One comparison for this many samples, and at most [`COMPARISONS`].
const SHARE: usize = 50;

const COMPARISONS: usize = 200;

/// One in this many compares a way, too.
const WAYS: usize = 2;

/// Ways of this share begin and end just inside a radius.
const INSIDE: f64 = 1.0 - 1e-13;

/// Every q and every way at which two methods differ, and every claim that a collision found there breaks.
pub(super) fn compare(
    model: &ReducedModel,
    certificates: &Certificates,
    (claims, minimum): (&Claims<'_>, &Minimum<'_>),
    options: &AuditOptions,
    progress: &dyn Progress,
) -> Result<Vec<String>, Error> {
    let query = |method| Query::with_method(model, certificates, method);
    let (mut certified, mut traditional) = (query(Method::Certified)?, query(Method::Traditional)?);
    let mut brute_force = query(Method::BruteForce)?;
    let mut parts = certificates.parts().clone();
    parts.pair_tree = PairTree::default();
    let without_tree = Certificates::from_parts(parts)?;
    let mut nodes_alone = Query::with_method(model, &without_tree, Method::Certified)?;
    let small = model.mesh().faces().len() <= BRUTE_FORCE_TRIANGLES;
    let mut violations = Vec::new();
    let comparisons = (options.samples / SHARE).clamp(1, COMPARISONS);
    for sample in 0..comparisons {
        if progress.is_cancelled() {
            break;
        }
        let mut random = Random::new(options.seed, 2_000_000 + sample as u64);
        let q = random_q(certificates, &mut random, sample);
        let expected = traditional.discrete(&q)?.to_vec();
        let norm = traditional.norm();
        if certified.discrete(&q)? != expected {
            violations.push(format!("certified and traditional answers differ at q = {q:?}"));
        }
        if nodes_alone.discrete(&q)? != expected {
            violations.push(format!(
                "certified answers without pairs of nodes and traditional ones differ at q = {q:?}"
            ));
        }
        let by_brute_force = small || sample * 3 / comparisons != (sample + 1) * 3 / comparisons;
        if by_brute_force && brute_force.discrete(&q)? != expected {
            violations.push(format!("traditional and brute-force answers differ at q = {q:?}"));
        }
        let claimed = |pair: &Pair| certificates.exceptions().binary_search(pair).is_err();
        violations
            .extend(expected.into_iter().filter(claimed).find_map(|faces| claims.violation(faces, norm, &q)));
        if sample.is_multiple_of(WAYS) {
            let way = random_way(certificates, claims, &mut random, sample);
            let expected = traditional.continuous(&way[0], &way[1])?.to_vec();
            let mut differ = |query: &mut Query<'_>, what: &str| -> Result<(), Error> {
                let found = query.continuous(&way[0], &way[1])?;
                if let Some(missed) = missed(minimum, &expected, found, &way) {
                    let [a, b] = &way;
                    violations.push(format!(
                        "triangles {} and {} meet from q = {a:?} to {b:?}, which only one of the {what} answers says",
                        missed.0, missed.1
                    ));
                }
                Ok(())
            };
            differ(&mut certified, "certified and traditional")?;
            if by_brute_force && small {
                differ(&mut brute_force, "traditional and brute-force")?;
            }
        }
    }
    Ok(violations)
}

/// A pair listed by one answer alone that collides at an end of the way. Methods may differ in pairs that only come
/// close; between the ends rounding moves a shape off the straight way, so exact tests there would prove nothing.
fn missed(minimum: &Minimum<'_>, a: &[Impact], b: &[Impact], way: &[Vec<f64>; 2]) -> Option<Pair> {
    let lacks =
        |all: &[Impact], impact: &Impact| all.binary_search_by_key(&impact.pair, |other| other.pair).is_err();
    let mut only = a.iter().filter(|i| lacks(b, i)).chain(b.iter().filter(|i| lacks(a, i)));
    let missed = only.find(|impact| way.iter().any(|q| minimum.collides(impact.pair, q)));
    missed.map(|impact| impact.pair)
}

/// A random z whose entries decrease more or less, by the number of the sample.
fn random_z(rank: usize, random: &mut Random, sample: usize) -> Vec<f64> {
    let weight = |k: usize| (1.0 + k as f64).powi(sample as i32 % 3);
    random.normals(rank).iter().enumerate().map(|(k, z)| z / weight(k)).collect()
}

/// The q in the direction of z with a norm of about `goal`.
fn scaled_to(certificates: &Certificates, z: &[f64], goal: f64) -> Vec<f64> {
    let norm = z.iter().map(|z| z * z).sum::<f64>().sqrt();
    certificates.parts().scope.at(z, if norm > 0.0 { goal / norm } else { 0.0 })
}

/// A random q whose length lies between a fifth of the root's radius (or of the global one where that is 0) and
/// five times it; for every third up to the limit of the pair tree.
fn random_q(certificates: &Certificates, random: &mut Random, sample: usize) -> Vec<f64> {
    let z = random_z(certificates.center().len(), random, sample);
    let (root, global) = (certificates.root_radius(), certificates.global_radius());
    let limit = certificates.parts().pair_tree.limit();
    let radius = if root > 0.0 { root } else { global / 25.0 };
    let share = random.uniform() * random.uniform();
    let goal = match radius.is_finite() {
        true if sample % 3 == 2 && limit > 0.0 => limit * (1.0 - share * share),
        true => radius * (0.2 + 4.8 * share),
        false => 0.2 + 4.8 * share,
    };
    scaled_to(certificates, &z, goal)
}

/// Two random q; both just inside one radius for every other sample, else of any size.
fn random_way(
    certificates: &Certificates,
    claims: &Claims<'_>,
    random: &mut Random,
    sample: usize,
) -> [Vec<f64>; 2] {
    if sample.is_multiple_of(2 * WAYS) {
        return [(); 2].map(|()| random_q(certificates, random, sample));
    }
    let nodes = certificates.hierarchy().nodes().len();
    let radius = match random.below(3) {
        0 => certificates.root_radius(),
        1 => claims.random_pair(random, sample.is_multiple_of(4 * WAYS)).map_or(0.0, |claim| claim.radius),
        _ => claims.node(random.below(nodes) as u32).radius,
    };
    let goal = if radius.is_finite() { radius * INSIDE } else { 1.0 };
    [(); 2].map(|()| scaled_to(certificates, &random_z(certificates.center().len(), random, sample), goal))
}
