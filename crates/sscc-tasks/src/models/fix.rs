//! Selection of the vertices that do not move: a list, a box or a file.

use std::path::Path;

use glam::DVec3;
use sscc_io::read_vertex_numbers;

use super::source::SolidSource;
use crate::TaskError;
use crate::error::At;

/// Selected vertices, before the solid exists.
#[derive(Clone, Debug, PartialEq)]
pub enum Fix {
    /// All vertices in a box with these two corners, including vertices on its faces.
    Box([DVec3; 2]),
    /// Vertices of the source's file, counted from 0.
    Numbers(Vec<u32>),
}

impl Fix {
    /// Parses numbers counted from 0 as in `0,5,7`, `box:X0,Y0,Z0,X1,Y1,Z1`, or the name of a file of numbers, relative to
    /// `folder`. Errors begin with `key`.
    ///
    /// # Errors
    /// When the text is none of these, or the file cannot be read.
    pub fn parse(text: &str, folder: &Path, key: &str) -> Result<Self, TaskError> {
        if let Some(corners) = text.strip_prefix("box:") {
            let numbers: Result<Vec<f64>, _> = corners.split(',').map(|n| n.trim().parse()).collect();
            let is_finite = |numbers: &Vec<f64>| numbers.iter().all(|x| x.is_finite());
            let Some([x0, y0, z0, x1, y1, z1]) =
                numbers.ok().filter(is_finite).and_then(|n| <[f64; 6]>::try_from(n).ok())
            else {
                let cause = "six numbers were expected, as in box:-1,-1,-1,1,1,0";
                return Err(TaskError::refused(format_args!("{key} box"), cause));
            };
            return Ok(Self::Box([DVec3::new(x0, y0, z0), DVec3::new(x1, y1, z1)]));
        }
        let numbers: Result<Vec<u32>, _> = text.split(',').map(|n| n.trim().parse()).collect();
        if let Ok(numbers) = numbers {
            return Ok(Self::Numbers(numbers));
        }
        let form = "is neither a list of numbers nor box:X0,Y0,Z0,X1,Y1,Z1, so it must be a file";
        Ok(Self::Numbers(read_vertex_numbers(&folder.join(text)).at(|| format!("{key} {form}"))?))
    }

    /// Returns the selection in a solid whose lengths are multiplied by `factor`.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Box(corners) => Self::Box(corners.map(|corner| corner * factor)),
            Self::Numbers(_) => self.clone(),
        }
    }

    /// Returns the fixed vertices of the solid, sorted. For an embedded surface, a box also selects the vertices of the
    /// solid that move the surface's vertices in the box.
    ///
    /// # Errors
    /// When a vertex does not exist, or no vertex is selected.
    pub fn vertices(&self, source: &SolidSource) -> Result<Vec<u32>, TaskError> {
        let mut fixed = Vec::new();
        match self {
            Self::Box([a, b]) => fixed = source.within(a.min(*b), a.max(*b)),
            Self::Numbers(numbers) => {
                for number in numbers {
                    fixed.extend(source.holding(*number)?);
                }
            }
        }
        fixed.sort_unstable();
        fixed.dedup();
        if fixed.is_empty() {
            let cause = "enlarge or move the box, or name vertices of elements";
            return Err(TaskError::refused("this selects no vertex", cause));
        }
        Ok(fixed)
    }
}
