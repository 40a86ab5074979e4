//! Contact impulses by projected Gauss-Seidel: of soft contacts (springs), of rigid contacts (corrections of the end of a
//! step), and for the velocities at the end of a step.

pub(crate) mod contact_rows;
pub(crate) mod contact_solver;
pub(crate) mod correction;
pub(crate) mod correction_solver;
mod friction_cone;
mod gauss_seidel;
mod resting_velocities;
mod rigid_velocity;
