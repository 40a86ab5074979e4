//! The scenes that come with the program, and how one is found by its name.

use std::path::Path;

use super::scene::Scene;
use crate::error::SimError;
use crate::nearest::nearest;

/// The scenes that come with the program, near those of the paper's Table 1.
pub const SHIPPED: [(&str, &str); 5] = [
    ("spring", include_str!("../../../../scenes/spring.toml")),
    ("bunny16", include_str!("../../../../scenes/bunny16.toml")),
    ("bunny128", include_str!("../../../../scenes/bunny128.toml")),
    ("dragon-nonlinear", include_str!("../../../../scenes/dragon-nonlinear.toml")),
    ("dragon-polynomial", include_str!("../../../../scenes/dragon-polynomial.toml")),
];

/// Reads a scene: a file, or one that comes with the program by its name.
///
/// # Errors
/// As of [`Scene::read`]; of a name that is neither, the nearest one is named.
pub fn read_scene(path: &Path) -> Result<Scene, SimError> {
    let shipped = path.to_str().and_then(|name| SHIPPED.iter().find(|(known, _)| *known == name));
    match shipped {
        Some((name, text)) if !path.is_file() => Scene::parse(Path::new(&format!("{name}.toml")), text),
        // A name alone may be meant for a scene that comes with the program.
        None if path.extension().is_none() && !path.exists() => {
            let meant = nearest(&path.display().to_string(), SHIPPED.iter().map(|(name, _)| *name));
            let cause = format!("not found; did you mean '{}'?", meant.unwrap_or_default());
            Err(SimError::refused(path.display(), cause))
        }
        _ => Scene::read(path),
    }
}
