//! The scenarios by name.

use anyhow::{Result, bail};

use sscc_sim::nearest;
use sscc_sim::{SHIPPED, Scene};

/// What can be measured.
#[derive(Clone, Copy)]
pub enum Scenario {
    Amplitudes,
    Growth,
    Kinetic,
    /// Scenes that come with the program, by name and text, and which of the paper's tables to show beside the results.
    Scenes(&'static [(&'static str, &'static str)], PaperTable),
}

/// A table of the paper.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum PaperTable {
    None,
    /// Statistics of all scenes.
    One,
    /// Continuous queries, of the 16 bunnies.
    Two,
    /// What a simulation with sound spends its time on, of the spring.
    Three,
}

/// Scenarios that are no single scene.
const OTHERS: [(&str, Scenario, &str); 6] = [
    ("amplitudes", Scenario::Amplitudes, "bunny, dragon and spring at random q, displaced by 0.5 to 40%"),
    ("growth", Scenario::Growth, "springs of 4,000 to a million triangles"),
    ("kinetic", Scenario::Kinetic, "a spring that swings, 44,100 steps in a second: kinetic queries"),
    ("table1", Scenario::Scenes(&SHIPPED, PaperTable::One), "the five scenes, beside the paper's Table 1"),
    (
        "table2",
        Scenario::Scenes(&[SHIPPED[1]], PaperTable::Two),
        "bunny16, discrete and continuous, beside the paper's Table 2",
    ),
    (
        "table3",
        Scenario::Scenes(&[SHIPPED[0]], PaperTable::Three),
        "spring, what its time goes to, beside the paper's Table 3",
    ),
];

/// The scenarios that are one scene.
fn scenes() -> impl Iterator<Item = (&'static str, Scenario)> {
    SHIPPED
        .iter()
        .map(|shipped| (shipped.0, Scenario::Scenes(std::slice::from_ref(shipped), PaperTable::None)))
}

/// All by name.
fn all() -> impl Iterator<Item = (&'static str, Scenario)> {
    scenes().chain(OTHERS.iter().map(|(name, scenario, _)| (*name, *scenario)))
}

/// The list for people.
pub fn lines() -> Result<Vec<String>> {
    let line = |name: &str, about: &str| format!("{name:<20}{about}");
    let mut lines = Vec::new();
    for (name, text) in SHIPPED {
        lines.push(line(name, &Scene::parse(name.as_ref(), text)?.about));
    }
    lines.extend(OTHERS.iter().map(|(name, _, about)| line(name, about)));
    Ok(lines)
}

impl Scenario {
    /// # Errors
    /// When there is none of that name; the message has the nearest one.
    pub fn named(name: &str) -> Result<Self> {
        if let Some((_, scenario)) = all().find(|(known, _)| *known == name) {
            return Ok(scenario);
        }
        let meant = nearest(name, all().map(|(known, _)| known)).unwrap_or_default();
        bail!("there is no scenario '{name}'; did you mean '{meant}'? (sscc bench --list)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let mut names: Vec<&str> = all().map(|(name, _)| name).collect();
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
        assert!(lines().unwrap().iter().all(|line| line.len() > 40));
    }
}
