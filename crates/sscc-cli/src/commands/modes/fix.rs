//! Parses `--fix`, the vertices that do not move: a list, a box or a file.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use glam::DVec3;
use sscc_sim::SolidSource;

/// The parsed flag, before the solid exists.
pub struct Fix<'a> {
    typed: &'a str,
    selection: Selection,
}

enum Selection {
    /// All vertices in a box, its faces included.
    Box([DVec3; 2]),
    /// Vertices of the source's file, counted from 0.
    Numbers(Vec<u32>),
}

impl<'a> Fix<'a> {
    /// Parses the flag, and reads the file if it names one.
    pub fn parse(typed: &'a str) -> Result<Self> {
        if let Some(corners) = typed.strip_prefix("box:") {
            return Ok(Self { typed, selection: Selection::Box(corners_of(corners)?) });
        }
        let numbers: Result<Vec<u32>, _> = typed.split(',').map(|n| n.trim().parse()).collect();
        let numbers = match numbers {
            Ok(numbers) => numbers,
            Err(_) => from_file(Path::new(typed))?,
        };
        Ok(Self { typed, selection: Selection::Numbers(numbers) })
    }

    /// Returns the fixed vertices of the solid, sorted. For a surface in a lattice, these are the lattice vertices that
    /// hold the selected vertices.
    pub fn vertices(&self, source: &SolidSource) -> Result<Vec<u32>> {
        let (typed, mut fixed) = (self.typed, Vec::new());
        match &self.selection {
            Selection::Box([a, b]) => fixed = source.within(a.min(*b), a.max(*b)),
            Selection::Numbers(numbers) => {
                for number in numbers {
                    fixed.extend(source.holding(*number).with_context(|| format!("--fix {typed}"))?);
                }
            }
        }
        fixed.sort_unstable();
        fixed.dedup();
        ensure!(!fixed.is_empty(), "--fix {typed}: this selects no vertex");
        Ok(fixed)
    }
}

fn from_file(path: &Path) -> Result<Vec<u32>> {
    let numbers = sscc_io::read_vector(path)
        .context("--fix is neither a list of numbers nor box:X0,Y0,Z0,X1,Y1,Z1, so it must be a file")?;
    let whole = |x: &f64| match *x {
        x if x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0 => Ok(x as u32),
        x => bail!("{}: {x} is not a vertex number", path.display()),
    };
    numbers.iter().map(whole).collect()
}

fn corners_of(typed: &str) -> Result<[DVec3; 2]> {
    let numbers: Result<Vec<f64>, _> = typed.split(',').map(|n| n.trim().parse()).collect();
    let Ok([x0, y0, z0, x1, y1, z1]) = numbers.as_deref() else {
        bail!("--fix box: six numbers were expected, as in box:-1,-1,-1,1,1,0");
    };
    Ok([DVec3::new(*x0, *y0, *z0), DVec3::new(*x1, *y1, *z1)])
}
