//! Scenes that come with the program, and their lookup by name.

use std::path::Path;

use sscc_tasks::nearest;

use super::scene::Scene;
use crate::error::SimError;

/// Names and texts of the scenes of the paper's Table 1, with the Earth's gravity and real materials.
pub const SHIPPED: [(&str, &str); 5] = [
    ("spring", include_str!("../../scenes/spring.toml")),
    ("bunny16", include_str!("../../scenes/bunny16.toml")),
    ("bunny128", include_str!("../../scenes/bunny128.toml")),
    ("dragon-nonlinear", include_str!("../../scenes/dragon-nonlinear.toml")),
    ("dragon-polynomial", include_str!("../../scenes/dragon-polynomial.toml")),
];

/// Names and texts of scenes that suit the method: most steps are within the root's radius, in a metric measured from their
/// own motion.
pub const OWN_AMPLITUDE_SCENES: [(&str, &str); 2] = [
    ("spring-gentle", include_str!("../../scenes/spring-gentle.toml")),
    ("bunny16-gentle", include_str!("../../scenes/bunny16-gentle.toml")),
];

/// Reads a scene: a file, or by its name a scene that comes with the program.
///
/// # Errors
/// The errors of [`Scene::read`]. If a name without an extension is neither a file nor a scene, the error states the
/// nearest name.
pub fn read_scene(path: &Path) -> Result<Scene, SimError> {
    let all = || SHIPPED.iter().chain(&OWN_AMPLITUDE_SCENES);
    let shipped = path.to_str().and_then(|name| all().find(|(known, _)| *known == name));
    match shipped {
        Some((name, text)) if !path.is_file() => Scene::parse(Path::new(&format!("{name}.toml")), text),
        // A name without an extension may be a mistyped name of a scene that comes with the program.
        None if path.extension().is_none() && !path.exists() => {
            let meant = nearest(&path.display().to_string(), all().map(|(name, _)| *name));
            let cause = format!("not found; did you mean '{}'?", meant.unwrap_or_default());
            Err(SimError::refused(path.display(), cause))
        }
        _ => Scene::read(path),
    }
}
