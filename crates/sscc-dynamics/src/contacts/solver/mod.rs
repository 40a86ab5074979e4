//! Impulses of contacts by projected Gauss-Seidel: of springs (soft contacts), of corrections of the end of a step (rigid
//! contacts), and of the velocities there.

pub(crate) mod contact_rows;
pub(crate) mod contact_solver;
pub(crate) mod correction;
pub(crate) mod correction_solver;
mod friction_cone;
mod gauss_seidel;
mod resting_velocities;
mod rigid_velocity;
