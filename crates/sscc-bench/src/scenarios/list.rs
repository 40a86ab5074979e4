//! List of the scenarios by name.

use sscc_sim::{OWN_AMPLITUDE_SCENES, SHIPPED, Scene};
use sscc_tasks::nearest;

use super::models::ModelsScenario;
use crate::error::Error;
use crate::figures::Figure;
use crate::paper::PaperTable;

/// A scenario of the benches.
#[derive(Clone, Copy, Debug)]
pub enum Scenario {
    /// Models by name.
    Models(ModelsScenario),
    /// Springs of several sizes: see [`GROWTH_SIZES`](crate::GROWTH_SIZES).
    Growth,
    /// Motions in small steps: see [`KineticBench`](crate::KineticBench).
    Kinetic,
    /// Diagrams of the paper.
    Figure(Figure),
    /// Scenes that come with the program, see [`measure_scene`](crate::measure_scene).
    Scenes {
        /// Their names and texts.
        scenes: &'static [(&'static str, &'static str)],
        /// The table of the paper to print beside the results, if any.
        table: Option<PaperTable>,
    },
}

/// A scenario in a list.
#[derive(Clone, Debug)]
pub struct ListedScenario {
    /// Its name.
    pub name: &'static str,
    /// Its description, in one line.
    pub about: String,
}

/// Scenarios other than single scenes.
const OTHERS: [(&str, Scenario, &str); 13] = [
    (
        "amplitudes",
        Scenario::Models(ModelsScenario::Amplitudes),
        "bunny, dragon and spring at random q, displaced by 0.5 to 40%",
    ),
    (
        "figure7",
        Scenario::Figure(Figure::RadiiOfLevels),
        "the radii of each level of the bunny's hierarchy, the paper's Figure 7",
    ),
    (
        "figure9",
        Scenario::Figure(Figure::MetricsOverModes),
        "the spring's root radius under two metrics, the paper's Figure 9",
    ),
    (
        "figure11",
        Scenario::Figure(Figure::ExtremalShapes),
        "the bunny at its root's radius along the first modes, the paper's Figure 11",
    ),
    (
        "figure12",
        Scenario::Scenes { scenes: &[SHIPPED[1]], table: None },
        "bunny16, the cost of each step, the paper's Figure 12",
    ),
    (
        "figure14",
        Scenario::Figure(Figure::GeometricModes),
        "the dragon at its root's radius, polynomials and vibrations, the paper's Figure 14",
    ),
    ("growth", Scenario::Growth, "springs of 4,000 to a million triangles"),
    ("kinetic", Scenario::Kinetic, "a spring that vibrates, 44,100 steps per second: kinetic queries"),
    (
        "mixed",
        Scenario::Models(ModelsScenario::Mixed),
        "springs, bunny and dragon that swing in all their modes at once",
    ),
    (
        "norms",
        Scenario::Models(ModelsScenario::Norms),
        "bunny, dragon and spring at random q, |z| 0.5 to 32 times the root's radius",
    ),
    (
        "table1",
        Scenario::Scenes { scenes: &SHIPPED, table: Some(PaperTable::One) },
        "the five scenes, beside the paper's Table 1",
    ),
    (
        "table2",
        Scenario::Scenes { scenes: &[SHIPPED[1]], table: Some(PaperTable::Two) },
        "bunny16, discrete and continuous, beside the paper's Table 2",
    ),
    (
        "table3",
        Scenario::Scenes { scenes: &[SHIPPED[0]], table: Some(PaperTable::Three) },
        "spring, the shares of its time, beside the paper's Table 3",
    ),
];

/// Returns all scenarios by name, single scenes first.
fn all() -> impl Iterator<Item = (&'static str, Scenario)> {
    let single = |shipped: &'static (&'static str, &'static str)| {
        (shipped.0, Scenario::Scenes { scenes: std::slice::from_ref(shipped), table: None })
    };
    SHIPPED
        .iter()
        .chain(&OWN_AMPLITUDE_SCENES)
        .map(single)
        .chain(OTHERS.iter().map(|(name, scenario, _)| (*name, *scenario)))
}

impl Scenario {
    /// Returns the scenario of a name.
    ///
    /// # Errors
    /// When no scenario has the name; the message names the nearest one.
    pub fn from_name(name: &str) -> Result<Self, Error> {
        if let Some((_, scenario)) = all().find(|(known, _)| *known == name) {
            return Ok(scenario);
        }
        let nearest = nearest(name, all().map(|(known, _)| known)).unwrap_or_default();
        Err(Error::NoScenario { name: name.to_owned(), nearest })
    }

    /// Returns all scenarios.
    ///
    /// # Errors
    /// When a scene cannot be parsed.
    pub fn list() -> Result<Vec<ListedScenario>, Error> {
        let mut list = Vec::new();
        for (name, text) in SHIPPED.into_iter().chain(OWN_AMPLITUDE_SCENES) {
            list.push(ListedScenario { name, about: Scene::parse(name.as_ref(), text)?.about });
        }
        list.extend(OTHERS.iter().map(|(name, _, about)| ListedScenario { name, about: (*about).into() }));
        Ok(list)
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
        let list = Scenario::list().unwrap();
        assert!(
            list.iter().all(|listed| listed.about.len() > 20 && Scenario::from_name(listed.name).is_ok())
        );
        assert_eq!(list.len(), names.len());
    }
}
