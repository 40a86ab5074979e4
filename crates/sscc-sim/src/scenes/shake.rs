//! The shake of a body: rates of its first modes at the beginning, in one of three units.

use super::section::Section;
use crate::error::{Result, SimError};

/// Rates of the first modes at the beginning. The rates of all other modes are 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shake {
    /// One number for each of the first modes; its sign is that of the rate.
    pub values: Vec<f64>,
    /// The unit of the numbers.
    pub unit: ShakeUnit,
}

/// The unit of a shake.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShakeUnit {
    /// Rates of q (m/s root of kg): the kinetic energy is half the square.
    #[default]
    Rate,
    /// Kinetic energies (J).
    Energy,
    /// Speeds of the fastest vertex (m/s).
    Speed,
}

const UNITS: [(&str, ShakeUnit); 2] = [("energy", ShakeUnit::Energy), ("speed", ShakeUnit::Speed)];

impl Shake {
    /// Reads `shake = [...]`, `shake = { energy = [...] }` or `shake = { speed = [...] }`. `rank` is the number of modes if
    /// it is known.
    pub(super) fn read(body: &Section<'_>, rank: Option<usize>) -> Result<Self> {
        let shake = if body.is_table("shake") {
            let table = body.section("shake", &UNITS.map(|(key, _)| key))?;
            let table = body.require("shake", table)?;
            let given: Vec<(&str, ShakeUnit)> = UNITS.into_iter().filter(|(key, _)| table.has(key)).collect();
            let [(key, unit)] = given[..] else {
                return Err(body.refused("shake", "one of energy (J) and speed (m/s) was expected"));
            };
            Self { values: table.numbers(key)?.unwrap_or_default(), unit }
        } else {
            Self { values: body.numbers("shake")?.unwrap_or_default(), unit: ShakeUnit::Rate }
        };
        if let Some(rank) = rank.filter(|rank| shake.values.len() > *rank) {
            return Err(body.refused("shake", format!("{} numbers for {rank} modes", shake.values.len())));
        }
        Ok(shake)
    }

    /// Returns the rates of all modes. `reach` has the largest displacement of a vertex by a unit of each mode (m).
    ///
    /// # Errors
    /// When there are more numbers than modes, or a speed is given for a mode that moves no vertex.
    pub fn rates(&self, reach: &[f64]) -> Result<Vec<f64>, SimError> {
        if self.values.len() > reach.len() {
            let cause = format!("{} numbers for {} modes", self.values.len(), reach.len());
            return Err(SimError::refused("shake", cause));
        }
        let mut rates = vec![0.0; reach.len()];
        for (mode, (rate, (value, reach))) in rates.iter_mut().zip(self.values.iter().zip(reach)).enumerate()
        {
            *rate = match self.unit {
                ShakeUnit::Rate => *value,
                ShakeUnit::Energy => (2.0 * value.abs()).sqrt().copysign(*value),
                ShakeUnit::Speed if *value == 0.0 => 0.0,
                ShakeUnit::Speed => value / reach,
            };
            if !rate.is_finite() {
                let cause = format!("mode {mode} (counted from 0) moves no vertex: give its energy, or 0");
                return Err(SimError::refused("shake", cause));
            }
        }
        Ok(rates)
    }

    /// Multiplies the rates by a factor, and keeps only the rates of the first `rank` modes.
    pub(super) fn quicken(&mut self, factor: f64, rank: usize) {
        let factor = if self.unit == ShakeUnit::Energy { factor * factor } else { factor };
        self.values.truncate(rank);
        self.values.iter_mut().for_each(|value| *value *= factor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rates_follow_from_energies_and_speeds() {
        let reach = [0.5, 0.25, 0.0];
        let rates = |values: &[f64], unit| Shake { values: values.to_vec(), unit }.rates(&reach).unwrap();
        assert_eq!(rates(&[3.0], ShakeUnit::Rate), [3.0, 0.0, 0.0]);
        assert_eq!(rates(&[0.0, -8.0], ShakeUnit::Energy), [0.0, -4.0, 0.0]);
        assert_eq!(rates(&[1.0, -1.0, 0.0], ShakeUnit::Speed), [2.0, -4.0, 0.0]);
        let refused = |values: &[f64]| {
            let shake = Shake { values: values.to_vec(), unit: ShakeUnit::Speed };
            shake.rates(&reach).unwrap_err().to_string()
        };
        assert!(refused(&[1.0; 3]).starts_with("shake: mode 2 (counted from 0) moves no vertex"));
        assert_eq!(refused(&[1.0; 4]), "shake: 4 numbers for 3 modes");
        let mut energy = Shake { values: vec![1.0, 2.0], unit: ShakeUnit::Energy };
        energy.quicken(4.0, 1);
        assert_eq!(energy.values, [16.0]);
    }
}
