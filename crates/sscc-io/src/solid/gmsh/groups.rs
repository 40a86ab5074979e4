//! Parser for `$PhysicalNames` and `$Entities`, which give the materials of volumes.

use std::collections::BTreeMap;

use super::numbers::Numbers;
use crate::FormatError;
use crate::solid::builder::Builder;
use crate::solid::words::Words;
use crate::text::decoded;

/// Dimension of volumes.
const VOLUME: i64 = 3;

const LAST_NAME: &str = "the last name";
const LAST_ENTITY: &str = "the last entity";

#[derive(Default)]
pub(super) struct Groups {
    /// Names of the physical groups of volumes.
    names: BTreeMap<u64, String>,
    /// First physical group of each volume with groups (version 4).
    of_volume: BTreeMap<i64, u64>,
}

impl Groups {
    /// Reads the lines `dimension number "name"`, which are text in binary files, too.
    pub fn read_names(&mut self, words: &mut Words) -> Result<(), FormatError> {
        let count = words.count("the number of names")?;
        words.rest_of_line();
        for _ in 0..count {
            let (dimension, number) = (words.integer(LAST_NAME)?, words.integer(LAST_NAME)?);
            let place = words.place();
            let name = decoded(words.rest_of_line(), 0)
                .map_err(|error| FormatError::new(place.clone(), error.cause().clone()))?
                .trim_ascii();
            let Some(name) = name.strip_prefix('"').and_then(|name| name.strip_suffix('"')) else {
                return Err(FormatError::new(place, "a name in double quotes was expected"));
            };
            if dimension == VOLUME {
                self.names.insert(number.unsigned_abs(), name.to_owned());
            }
        }
        Ok(())
    }

    /// Reads points, curves, surfaces and volumes: tag, bounding box (for a point its position), physical groups, and the tags
    /// of bounding entities (not for points).
    pub fn read_entities(&mut self, numbers: &mut Numbers) -> Result<(), FormatError> {
        let mut counts = [0; 4];
        for count in &mut counts {
            *count = numbers.size("the number of entities")?;
        }
        for (dimension, count) in (0..=VOLUME).zip(counts) {
            for _ in 0..count {
                self.entity(numbers, dimension)?;
            }
        }
        Ok(())
    }

    fn entity(&mut self, numbers: &mut Numbers, dimension: i64) -> Result<(), FormatError> {
        let tag = numbers.integer(LAST_ENTITY)?;
        for _ in 0..if dimension == 0 { 3 } else { 6 } {
            numbers.number(LAST_ENTITY)?;
        }
        let groups = numbers.size(LAST_ENTITY)?;
        if groups > 0 {
            // A group number is negative if the entity is reversed.
            let first = numbers.integer(LAST_ENTITY)?.unsigned_abs();
            numbers.skip_integers(groups - 1, LAST_ENTITY)?;
            if dimension == VOLUME {
                self.of_volume.insert(tag, first);
            }
        }
        if dimension > 0 {
            let bounding = numbers.size(LAST_ENTITY)?;
            numbers.skip_integers(bounding, LAST_ENTITY)?;
        }
        Ok(())
    }

    /// Returns the material of a physical group; 0 means no group.
    pub fn material(&self, group: u64, builder: &mut Builder) -> u32 {
        match (group, self.names.get(&group)) {
            (0, _) => builder.default_material(),
            (_, Some(name)) => builder.material(name),
            (_, None) => builder.material(&group.to_string()),
        }
    }

    /// Returns the material of the elements of a volume.
    pub fn material_of_volume(&self, volume: i64, builder: &mut Builder) -> u32 {
        self.material(self.of_volume.get(&volume).copied().unwrap_or_default(), builder)
    }
}
