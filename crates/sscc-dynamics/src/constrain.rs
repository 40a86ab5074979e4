//! The cheap response to self-collisions (paper, section 7): q stays in the ellipsoid that the root's certificate
//! proves free.

use sscc::Certificates;

use crate::DynamicsError;
use crate::body::Body;

/// Takes q back to the ellipsoid, and from v what leads out of it. Where the ellipsoid is centred at the rest pose,
/// both lose energy.
///
/// # Errors
/// When q is no configuration.
pub(crate) fn constrain(body: &mut Body<'_>) -> Result<(), DynamicsError> {
    let certificates = body.shape().certificates();
    if certificates.norm(&body.q) < certificates.root_radius() {
        return Ok(());
    }
    let Some(clamped) = certificates.clamp(&body.q)? else { return Ok(()) };
    body.q.copy_from_slice(&clamped);
    // Outwards is where the norm grows: the gradient of |S (q - c)|^2 / 2.
    let outwards = gradient(certificates, &body.q);
    let square: f64 = outwards.iter().map(|x| x * x).sum();
    let along: f64 = outwards.iter().zip(&body.v).map(|(x, v)| x * v).sum();
    if along > 0.0 && square > 0.0 {
        body.v.iter_mut().zip(&outwards).for_each(|(v, x)| *v -= x * (along / square));
    }
    body.was_pushed();
    Ok(())
}

/// Of `|S (q - c)|^2 / 2`: `S' S (q - c)`.
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
