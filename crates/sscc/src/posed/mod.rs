//! Shapes in the world, one against another (paper, section 7: collisions between objects).

mod half_space;
mod pose;
mod posed_motion;
mod posed_shape;
mod swept_shape;

pub use pose::Pose;
pub use posed_shape::PosedShape;
pub use swept_shape::SweptShape;
