//! Creates the world of a scene at its beginning, or restores it from a checkpoint.

use glam::DVec3;
use sscc_dynamics::{SoundBank, Start, State, World};
use sscc_io::Setting;

use super::prepared::PreparedScene;
use crate::error::{At, Result, SimError};
use crate::scenes::{BodySpec, Scene};

/// Returns the world of a scene at its beginning.
pub fn world(scene: &Scene, prepared: &PreparedScene) -> Result<World> {
    let mut world = World::new(scene.options())?;
    for (number, body) in scene.bodies.iter().enumerate() {
        let at = || format!("body {number} (counted from 0)");
        let BodySpec { model, orientation, velocity, angular_velocity, shake, .. } = body;
        let model = &prepared.models[*model];
        let is_free = !model.is_held();
        if !is_free && (*velocity != DVec3::ZERO || *angular_velocity != DVec3::ZERO) {
            let cause = "vertices of its model are fixed, so it does not move as a whole: leave out velocity and \
                         angular_velocity";
            return Err(SimError::refused(at(), cause));
        }
        let v = shake.rates(model.shape.reach()).at(at)?;
        let start = Start {
            is_free,
            position: Some(body.place(if is_free { DVec3::ZERO } else { model.shape.mass().center })),
            orientation: *orientation * model.upright,
            velocity: *velocity,
            spin: *angular_velocity,
            v,
            damping: scene.models[body.model].damping,
            detection: scene.detection,
            ..Start::default()
        };
        world.add(&model.shape, &start).at(at)?;
    }
    world.check_start()?;
    Ok(world)
}

/// Restores a world and its sounds from the memory of a checkpoint.
pub fn restore(
    world: &mut World,
    sounds: &mut [Option<SoundBank>],
    step: usize,
    memory: &[f64],
) -> Result<()> {
    let all: usize = sounds.iter().flatten().map(|bank| bank.state().len()).sum();
    let (numbers, mut rest) = memory.split_at_checked(memory.len().saturating_sub(all)).unwrap_or_default();
    let at = || "the checkpoint".to_owned();
    world.restore(&State { step: step as u64, numbers: numbers.to_vec() }).at(at)?;
    for bank in sounds.iter_mut().flatten() {
        let (own, others) = rest.split_at_checked(bank.state().len()).ok_or_else(|| {
            SimError::refused("the checkpoint", "too short; begin again with " + Setting::Restart)
        })?;
        bank.restore(own).at(at)?;
        rest = others;
    }
    Ok(())
}
