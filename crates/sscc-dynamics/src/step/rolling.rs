//! Rolling friction: the ground resists the rotation of bodies that lie on it.

use crate::Body;
use crate::contacts::contact_constraint::Source;
use crate::contacts::solver::correction::Correction;

/// Arm of the resisting torque, as a share of the body's radius: a chosen number. Soft bodies lose energy by the
/// deformation that moves along their surface, which a few modes do not show. Without it a bunny rocks for more than half
/// a minute (docs/notes/dynamics.md#contacts-between-bodies).
const ROLLING_FRICTION: f64 = 0.05;

/// Lowers the angular momentum of each free body by at most the arm times its normal impulses from the ground.
pub(crate) fn resist_rolling(bodies: &mut [Body], corrections: &[Correction]) {
    for constraint in corrections {
        let body = &mut bodies[constraint.points.bodies[0] as usize];
        let length = body.rigid.angular_momentum.length();
        if !matches!(constraint.points.source, Source::Vertex(_)) || !body.is_free() || length == 0.0 {
            continue;
        }
        let before = body.rigid.energy();
        let arm = ROLLING_FRICTION * body.shape().radius();
        body.rigid.angular_momentum *=
            (1.0 - arm * constraint.total_impulse().dot(constraint.points.normal) / length).max(0.0);
        body.energy_budget += (before - body.rigid.energy()).max(0.0);
    }
}
