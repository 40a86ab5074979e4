//! Reads the bodies of a scene: `[[bodies]]`, each a single body or a grid.

use glam::{DQuat, DVec3};
use sscc_tasks::nearest;

use super::models::ModelSpec;
use super::section::Section;
use super::shake::Shake;
use crate::error::Result;

/// Maximum number of bodies of a scene.
const MAX_BODIES: usize = 4096;

/// A body at the beginning of a scene.
#[derive(Clone, Debug)]
pub struct BodySpec {
    /// Index of its model.
    pub model: usize,
    /// Position of the centre of mass (m) of the first body of its grid, or of itself. None means the origin, or for a held body
    /// its position in the file.
    pub position: Option<DVec3>,
    /// Displacement from there to its place in a grid (m).
    pub offset: DVec3,
    /// Rotation from the axes of its model to those of the world.
    pub orientation: DQuat,
    /// Velocity (m/s).
    pub velocity: DVec3,
    /// Angular velocity (rad/s), in axes of the world.
    pub angular_velocity: DVec3,
    /// Rates of the first modes.
    pub shake: Shake,
}

impl BodySpec {
    /// Returns the position of the centre of mass (m). `default` replaces a missing position.
    pub fn place(&self, default: DVec3) -> DVec3 {
        self.position.unwrap_or(default) + self.offset
    }
}

const KEYS: [&str; 9] =
    ["model", "position", "rotation", "velocity", "angular_velocity", "shake", "grid", "spacing", "turn"];

/// Reads all bodies of a scene.
pub fn read(scene: &Section<'_>, models: &[ModelSpec]) -> Result<Vec<BodySpec>> {
    let mut bodies = Vec::new();
    for section in scene.sections("bodies", &KEYS)? {
        push(&section, models, &mut bodies)?;
        if bodies.len() > MAX_BODIES {
            return Err(
                scene.refused("bodies", format!("a scene may have at most {MAX_BODIES} bodies: use fewer"))
            );
        }
    }
    if bodies.is_empty() {
        return Err(scene.refused("bodies", "the scene has no bodies: add at least one [[bodies]]"));
    }
    Ok(bodies)
}

/// Appends the bodies of one section.
fn push(section: &Section<'_>, models: &[ModelSpec], bodies: &mut Vec<BodySpec>) -> Result<()> {
    let name = section.require("model", section.text("model")?)?;
    let Some(model) = models.iter().position(|model| model.recipe.name == name) else {
        let meant = nearest(name, models.iter().map(|model| model.recipe.name.as_str()));
        let cause = match meant {
            None => "the scene has no models: add a table [models.NAME]".into(),
            Some(meant) => format!("there is no such model; did you mean '{meant}'?"),
        };
        return Err(section.refused("model", cause));
    };
    let shake = Shake::read(section, models[model].recipe.modes.rank())?;
    let first = BodySpec {
        model,
        position: section.vector("position")?,
        offset: DVec3::ZERO,
        orientation: rotation(section)?,
        velocity: section.vector("velocity")?.unwrap_or(DVec3::ZERO),
        angular_velocity: section.vector("angular_velocity")?.unwrap_or(DVec3::ZERO),
        shake,
    };
    let turn = section.number("turn")?.unwrap_or(0.0).to_radians();
    let spacing = section.vector("spacing")?;
    let Some(grid) = section.vector("grid")? else {
        for key in ["turn", "spacing"] {
            if section.has(key) {
                return Err(section.refused(key, "this key needs grid: add grid, or leave it out"));
            }
        }
        bodies.push(first);
        return Ok(());
    };
    let is_count = |x: f64| x >= 1.0 && x.fract() == 0.0 && x <= MAX_BODIES as f64;
    if !grid.to_array().into_iter().all(is_count) || grid.element_product() > MAX_BODIES as f64 {
        let cause = format!("three whole numbers were expected, whose product is at most {MAX_BODIES}");
        return Err(section.refused("grid", cause));
    }
    let spacing = section.require("spacing", spacing)?;
    let [nx, ny, nz] = grid.to_array().map(|x| x as usize);
    for (k, j, i) in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| (k, j, i)))) {
        let number = i + nx * (j + ny * k);
        bodies.push(BodySpec {
            offset: spacing * DVec3::new(i as f64, j as f64, k as f64),
            // The rotation is about the body's own upright axis. After a rotation about the vertical, all bodies would fall
            // alike.
            orientation: first.orientation * DQuat::from_axis_angle(DVec3::Z, turn * number as f64),
            ..first.clone()
        });
    }
    Ok(())
}

fn rotation(section: &Section<'_>) -> Result<DQuat> {
    let Some(rotation) = section.section("rotation", &["axis", "degrees"])? else {
        return Ok(DQuat::IDENTITY);
    };
    let axis = rotation.require("axis", rotation.vector("axis")?)?;
    let degrees = rotation.require("degrees", rotation.number("degrees")?)?;
    match axis.try_normalize() {
        Some(axis) => Ok(DQuat::from_axis_angle(axis, degrees.to_radians())),
        None => {
            Err(rotation.refused("axis", "the axis is 0: give an axis with a direction, such as [0, 0, 1]"))
        }
    }
}
