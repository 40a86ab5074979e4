//! Sets of elements, and regions that assign materials to them.

use std::collections::BTreeMap;

use sscc_solid::NamedMaterial;

use crate::error::quoted;
use crate::{FormatError, Place};

/// Name of the set of all elements. A definition of this set in a file is ignored, as in VegaFEM.
const ALL_ELEMENTS: &str = "allElements";

/// Placeholder for an undecided material.
const UNDECIDED: u32 = u32::MAX;

#[derive(Default)]
pub(super) struct Regions {
    names: BTreeMap<String, usize>,
    sets: Vec<Vec<u32>>,
    regions: Vec<Region>,
}

struct Region {
    set: String,
    material: String,
    place: Place,
}

/// Removes all white space from a name.
pub(super) fn compact(name: &str) -> String {
    name.chars().filter(|c| !c.is_ascii_whitespace()).collect()
}

impl Regions {
    pub fn begin_set(&mut self, name: String) -> Result<(), String> {
        if self.names.contains_key(&name) {
            return Err(format!("the set {} is repeated", quoted(&name)));
        }
        self.names.insert(name, self.sets.len());
        self.sets.push(Vec::new());
        Ok(())
    }

    /// Adds an element (from 0) to the latest set.
    pub fn add(&mut self, element: u32) {
        if let Some(set) = self.sets.last_mut() {
            set.push(element);
        }
    }

    /// Adds a region: `set, material`.
    pub fn push(&mut self, text: &str, place: &Place) -> Result<(), String> {
        let Some((set, material)) = text.split_once(',') else {
            return Err(format!("'set, material' was expected, not {}", quoted(text)));
        };
        self.regions.push(Region { set: compact(set), material: compact(material), place: place.clone() });
        Ok(())
    }

    /// Returns the material of each element: that of the last region that contains it, else the last material.
    pub fn materials(&self, elements: usize, materials: &[NamedMaterial]) -> Result<Vec<u32>, FormatError> {
        let by_name: BTreeMap<&str, u32> = materials.iter().map(|m| m.name.as_str()).zip(0..).collect();
        let mut of_element = vec![UNDECIDED; elements];
        // The loop goes backwards, because later regions override earlier ones. It visits each set once, because a file with
        // many regions of one large set would otherwise take quadratic time.
        let mut seen = vec![false; self.sets.len()];
        let mut all = false;
        for region in self.regions.iter().rev() {
            let unknown = |what, name| {
                let cause = format!("the region names the {what} {}, which does not exist", quoted(name));
                Err(FormatError::new(region.place.clone(), cause))
            };
            let Some(&material) = by_name.get(region.material.as_str()) else {
                return unknown("material", &region.material);
            };
            if region.set == ALL_ELEMENTS {
                if !std::mem::replace(&mut all, true) {
                    decide(&mut of_element, material);
                }
                continue;
            }
            let Some(&set) = self.names.get(&region.set) else { return unknown("set", &region.set) };
            if !std::mem::replace(&mut seen[set], true) {
                for element in &self.sets[set] {
                    let decided = &mut of_element[*element as usize];
                    *decided = if *decided == UNDECIDED { material } else { *decided };
                }
            }
        }
        decide(&mut of_element, (materials.len() as u32).saturating_sub(1));
        Ok(of_element)
    }
}

fn decide(of_element: &mut [u32], material: u32) {
    of_element.iter_mut().filter(|m| **m == UNDECIDED).for_each(|m| *m = material);
}
