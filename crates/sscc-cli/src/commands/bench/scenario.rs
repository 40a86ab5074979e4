//! The scenarios by name.

use anyhow::{Result, bail};

use super::recipe::{self, Recipe};

/// What can be measured.
#[derive(Clone, Copy)]
pub enum Scenario {
    Amplitudes,
    Growth,
    Kinetic,
    Scenes(&'static [Scene]),
}

/// Bodies that move for a while (paper, Table 1).
#[derive(Clone, Copy)]
pub struct Scene {
    pub name: &'static str,
    pub recipe: Recipe,
    pub objects: usize,
    about: &'static str,
}

const SCENES: &[Scene] = &[
    Scene {
        name: "spring",
        recipe: recipe::SPRING,
        objects: 1,
        about: "a spring swings freely in its linear modes",
    },
    Scene {
        name: "bunny16",
        recipe: recipe::BUNNY_NONLINEAR,
        objects: 16,
        about: "16 bunnies, nonlinear modes, one set of certificates",
    },
    Scene {
        name: "bunny128",
        recipe: recipe::BUNNY_NONLINEAR,
        objects: 128,
        about: "128 bunnies, nonlinear modes, one set of certificates",
    },
    Scene {
        name: "dragon-nonlinear",
        recipe: recipe::DRAGON_NONLINEAR,
        objects: 1,
        about: "a dragon, nonlinear modes",
    },
    Scene {
        name: "dragon-polynomial",
        recipe: recipe::DRAGON_POLYNOMIAL,
        objects: 1,
        about: "a dragon, quadratic polynomial modes",
    },
];

/// Scenarios that are no single scene.
const OTHERS: [(&str, Scenario, &str); 6] = [
    ("amplitudes", Scenario::Amplitudes, "bunny, dragon and spring at random q, displaced by 0.5 to 40%"),
    ("growth", Scenario::Growth, "springs of 4,000 to a million triangles"),
    ("kinetic", Scenario::Kinetic, "a spring that swings, 44,100 steps in a second: kinetic queries"),
    (
        "table1",
        Scenario::Scenes(SCENES),
        "the five scenes above; each tells what the paper's Tables 1 to 3 do",
    ),
    ("table2", Scenario::Scenes(SCENES), "the same"),
    ("table3", Scenario::Scenes(SCENES), "the same"),
];

/// All by name, with what they are.
fn all() -> impl Iterator<Item = (&'static str, Scenario, &'static str)> {
    let scenes =
        SCENES.iter().map(|scene| (scene.name, Scenario::Scenes(std::slice::from_ref(scene)), scene.about));
    scenes.chain(OTHERS)
}

/// The list for people.
pub fn lines() -> Vec<String> {
    all().map(|(name, _, about)| format!("{name:<20}{about}")).collect()
}

impl Scenario {
    /// # Errors
    /// When there is none of that name; the message has the nearest one.
    pub fn named(name: &str) -> Result<Self> {
        if let Some((_, scenario, _)) = all().find(|(known, ..)| *known == name) {
            return Ok(scenario);
        }
        let nearest = all().map(|(known, ..)| known).min_by_key(|known| edits(name, known));
        bail!(
            "there is no scenario '{name}'; did you mean '{}'? (sscc bench --list)",
            nearest.unwrap_or_default()
        )
    }
}

/// The number of characters to insert, delete or replace (Levenshtein).
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, y) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(x != *y);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_are_counted() {
        assert_eq!(["", "spring", "sprnig", "string"].map(|name| edits(name, "spring")), [6, 0, 2, 1]);
    }

    #[test]
    fn names_are_unique() {
        let mut names: Vec<&str> = all().map(|(name, ..)| name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
