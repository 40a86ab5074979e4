//! A hint at `--weld` if colliding pairs meet at corners that are equal, but not shared.

use std::path::{Path, PathBuf};

use sscc_tasks::DetectionAnswer;

use crate::output::{counted, grouped, note};

/// Counts the listed pairs of triangles that meet at one or two corners, which have equal positions, but different
/// vertex numbers. Triangles with three such corners are doubled, not neighbours.
#[derive(Default)]
pub struct SoupHint {
    pairs: usize,
    all: usize,
    /// File of the first of these pairs.
    file: Option<PathBuf>,
}

impl SoupHint {
    /// Adds the pairs of an answer within one mesh.
    pub fn add(&mut self, found: &DetectionAnswer<'_>) {
        let (faces, positions) = (found.mesh.faces(), found.mesh.rest_positions());
        let corners = |triangle: u32| faces[triangle as usize];
        let is_same = |a: u32, b: u32| a != b && positions[a as usize] == positions[b as usize];
        let meets = |&&(i, j): &&(u32, u32)| {
            let equal = |a: &&u32| corners(j).iter().any(|b| is_same(**a, *b));
            matches!(corners(i).iter().filter(equal).count(), 1 | 2)
        };
        let count = found.pairs.iter().filter(meets).count();
        self.pairs += count;
        self.all += found.pairs.len();
        if count > 0 {
            self.file.get_or_insert_with(|| found.file.to_owned());
        }
    }

    /// Prints the hint if there are such pairs; `model` names a file for answers without one.
    pub fn print(&self, model: &Path) {
        let Some(file) = &self.file else { return };
        let file = if file.as_os_str().is_empty() { model } else { file };
        let all = counted(self.all as u64, "colliding pair");
        let those =
            if self.pairs == self.all { all } else { format!("{} of {all}", grouped(self.pairs as u64)) };
        note(format_args!(
            "{}: in {those}, triangles have corners at equal positions but do not share them: with --weld they are neighbours, \
             which do not count",
            file.display()
        ));
    }
}
