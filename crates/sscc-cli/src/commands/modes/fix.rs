//! `--fix`: vertices that do not move, by list, box or file.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use glam::DVec3;
use sscc_sim::SolidSource;

/// What was typed, before the solid is there.
pub struct Fix<'a> {
    typed: &'a str,
    wanted: Wanted,
}

enum Wanted {
    /// Everything in a box, borders included.
    Box([DVec3; 2]),
    /// Vertices of the source's file, from 0.
    Numbers(Vec<u32>),
}

impl<'a> Fix<'a> {
    /// Reads the file, where one is named.
    pub fn parse(typed: &'a str) -> Result<Self> {
        if let Some(corners) = typed.strip_prefix("box:") {
            return Ok(Self { typed, wanted: Wanted::Box(corners_of(corners)?) });
        }
        let numbers: Result<Vec<u32>, _> = typed.split(',').map(|n| n.trim().parse()).collect();
        let numbers = match numbers {
            Ok(numbers) => numbers,
            Err(_) => from_file(Path::new(typed))?,
        };
        Ok(Self { typed, wanted: Wanted::Numbers(numbers) })
    }

    /// The vertices of the solid that are fixed: of a surface the corners of the lattice that hold those typed.
    pub fn vertices(&self, source: &SolidSource) -> Result<Vec<u32>> {
        let (typed, mut fixed) = (self.typed, Vec::new());
        match &self.wanted {
            Wanted::Box([a, b]) => fixed = source.within(a.min(*b), a.max(*b)),
            Wanted::Numbers(numbers) => {
                for number in numbers {
                    fixed.extend(source.holding(*number).with_context(|| format!("--fix {typed}"))?);
                }
            }
        }
        fixed.sort_unstable();
        fixed.dedup();
        ensure!(!fixed.is_empty(), "--fix {typed}: no vertex is there");
        Ok(fixed)
    }
}

fn from_file(path: &Path) -> Result<Vec<u32>> {
    let numbers = sscc_io::read_vector(path)
        .context("--fix is no list of numbers and no box:X0,Y0,Z0,X1,Y1,Z1, so a file was looked for")?;
    let whole = |x: &f64| match *x {
        x if x >= 0.0 && x <= f64::from(u32::MAX) && x.fract() == 0.0 => Ok(x as u32),
        x => bail!("{}: {x} is no vertex number", path.display()),
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
