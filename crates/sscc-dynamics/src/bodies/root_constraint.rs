//! Response to self-collisions without contacts: q stays in the ellipsoid that the root's certificate proves free
//! (paper, section 7).

use sscc::Certificates;

use super::body::Body;
use crate::DynamicsError;

/// Projects q onto the ellipsoid, and removes the outward component of v. If the ellipsoid is centred at the rest pose,
/// both lower the energy.
///
/// # Errors
/// When q has a wrong length or a number that is not finite.
pub(crate) fn constrain_to_root(body: &mut Body) -> Result<(), DynamicsError> {
    let certificates = body.shape.certificates();
    if certificates.norm(&body.q)? < certificates.root_radius() {
        return Ok(());
    }
    let Some(clamped) = certificates.clamp(&body.q)? else { return Ok(()) };
    body.q.copy_from_slice(&clamped);
    // The outward direction is the gradient of |S (q - c)|^2 / 2.
    let outwards = gradient(certificates, &body.q);
    let square: f64 = outwards.iter().map(|x| x * x).sum();
    let along: f64 = outwards.iter().zip(&body.v).map(|(x, v)| x * v).sum();
    if along > 0.0 && square > 0.0 {
        body.v.iter_mut().zip(&outwards).for_each(|(v, x)| *v -= x * (along / square));
    }
    body.mark_moved();
    Ok(())
}

/// Returns the gradient of `|S (q - c)|^2 / 2`, which is `S' S (q - c)`.
fn gradient(certificates: &Certificates, q: &[f64]) -> Vec<f64> {
    let offset: Vec<f64> = q.iter().zip(certificates.center()).map(|(q, c)| q - c).collect();
    let Some(factor) = certificates.metric().dense_factor() else {
        return certificates.metric().scales().iter().zip(offset).map(|(s, x)| s * s * x).collect();
    };
    let mut gradient = vec![0.0; q.len()];
    for row in factor.chunks_exact(q.len()) {
        let z: f64 = row.iter().zip(&offset).map(|(s, x)| s * x).sum();
        gradient.iter_mut().zip(row).for_each(|(g, s)| *g += s * z);
    }
    gradient
}
