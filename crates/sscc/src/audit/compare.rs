//! Answers of certified queries against the traditional method, and that against brute force.

use super::AuditOptions;
use super::random::Random;
use crate::{Certificates, Error, Method, Progress, Query, ReducedModel};

/// Brute force is quadratic: up to this many triangles for every sample, beyond for three of them.
const BRUTE_FORCE_TRIANGLES: usize = 2000;

/// One comparison for this many samples, and at most [`COMPARISONS`].
const SHARE: usize = 50;

const COMPARISONS: usize = 200;

/// Every q at which two methods differ.
pub(super) fn compare(
    model: &ReducedModel,
    certificates: &Certificates,
    options: &AuditOptions,
    progress: &dyn Progress,
) -> Result<Vec<String>, Error> {
    let query = |method| Query::with_method(model, certificates, method);
    let (mut certified, mut traditional) = (query(Method::Certified)?, query(Method::Traditional)?);
    let mut brute_force = query(Method::BruteForce)?;
    let small = model.mesh().faces().len() <= BRUTE_FORCE_TRIANGLES;
    let mut violations = Vec::new();
    let comparisons = (options.samples / SHARE).clamp(1, COMPARISONS);
    for sample in 0..comparisons {
        if progress.is_cancelled() {
            break;
        }
        let q = random_q(certificates, options.seed, sample);
        let expected = traditional.discrete(&q)?.to_vec();
        if certified.discrete(&q)? != expected {
            violations.push(format!("certified and traditional answers differ at q = {q:?}"));
        }
        if (small || sample * 3 / comparisons != (sample + 1) * 3 / comparisons)
            && brute_force.discrete(&q)? != expected
        {
            violations.push(format!("traditional and brute-force answers differ at q = {q:?}"));
        }
    }
    Ok(violations)
}

/// A random q whose length lies between a fifth of the root's radius (or of the global one where that is 0) and
/// five times it.
fn random_q(certificates: &Certificates, seed: u64, sample: usize) -> Vec<f64> {
    let mut random = Random::new(seed, 2_000_000 + sample as u64);
    let scope = &certificates.parts().scope;
    let weight = |k: usize| (1.0 + k as f64).powi(sample as i32 % 3);
    let z = random.normals(scope.center.len());
    let z: Vec<f64> = z.iter().enumerate().map(|(k, z)| z / weight(k)).collect();
    let (root, global) = (certificates.root_radius(), certificates.global_radius());
    let radius = if root > 0.0 { root } else { global / 25.0 };
    let goal =
        if radius.is_finite() { radius } else { 1.0 } * (0.2 + 4.8 * random.uniform() * random.uniform());
    let norm = z.iter().map(|z| z * z).sum::<f64>().sqrt();
    scope.at(&z, if norm > 0.0 { goal / norm } else { 0.0 })
}
