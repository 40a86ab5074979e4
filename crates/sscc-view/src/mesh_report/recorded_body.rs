//! The recording of one body: positions, colliding pairs and contact curves, frame by frame.

use glam::DVec3;
use sscc::TriMesh;
use sscc_tasks::DetectionAnswer;

use crate::ViewError;
use crate::scene::fits;

/// The recording of one body. Positions are relative to the centre of the recording.
pub(super) struct RecordedBody {
    pub name: String,
    /// The node of the scene, if the body is one.
    pub node: Option<usize>,
    /// Three vertex numbers for each triangle.
    pub faces: Vec<u32>,
    pub vertices: usize,
    /// Positions (frames x vertices x 3).
    pub positions: Vec<f32>,
    /// The AABB of all positions, as minimum and maximum.
    pub bounds: (DVec3, DVec3),
    /// For each frame its pairs. The second triangles may belong to another body of the recording.
    pub pairs: FrameLists<u32, 2>,
    /// Times of impact, one for each pair, of continuous checks.
    pub impacts: Vec<f32>,
    /// For each frame the segments of its contact curves.
    pub segments: FrameLists<f32, 6>,
}

/// For each frame a list of items of `N` values.
#[derive(Default)]
pub(super) struct FrameLists<T, const N: usize> {
    values: Vec<[T; N]>,
    /// End of the list of each frame.
    ends: Vec<usize>,
}

impl<T, const N: usize> FrameLists<T, N> {
    pub fn push(&mut self, value: [T; N]) {
        self.values.push(value);
    }

    /// Ends the list of the current frame.
    pub fn end_frame(&mut self) {
        self.ends.push(self.values.len());
    }

    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns the number of frames whose lists have ended.
    pub fn frames(&self) -> usize {
        self.ends.len()
    }

    /// Returns the range of a frame in the list of all frames; empty beyond the last frame.
    pub fn range(&self, frame: usize) -> std::ops::Range<usize> {
        let end = |frame: usize| self.ends.get(frame).copied().unwrap_or(self.values.len());
        if frame == 0 { 0..end(0) } else { end(frame - 1)..end(frame) }
    }

    /// Returns the list of a frame.
    pub fn of(&self, frame: usize) -> &[[T; N]] {
        &self.values[self.range(frame)]
    }
}

impl RecordedBody {
    pub fn new(name: String, node: Option<usize>, mesh: &TriMesh) -> Self {
        Self {
            name,
            node,
            faces: mesh.faces().as_flattened().to_vec(),
            vertices: mesh.rest_positions().len(),
            positions: Vec::new(),
            bounds: (DVec3::INFINITY, DVec3::NEG_INFINITY),
            pairs: FrameLists::default(),
            impacts: Vec::new(),
            segments: FrameLists::default(),
        }
    }

    /// Adds the positions of the next frame.
    ///
    /// # Errors
    /// If a coordinate exceeds the range of the page.
    pub fn push_positions(&mut self, positions: &[DVec3], center: DVec3) -> Result<(), ViewError> {
        let (min, max) = &mut self.bounds;
        for p in positions {
            let relative = *p - center;
            if !fits(relative) {
                return Err(ViewError::Range);
            }
            *min = min.min(relative);
            *max = max.max(relative);
            self.positions.extend(relative.as_vec3().to_array());
        }
        Ok(())
    }

    /// Adds the pairs of the next frame.
    pub fn push_pairs(&mut self, answer: &DetectionAnswer<'_>) {
        answer.pairs.iter().for_each(|&(i, j)| self.pairs.push([i, j]));
        self.pairs.end_frame();
        self.impacts.extend(answer.times.into_iter().flatten().map(|time| *time as f32));
    }

    /// Returns the size of the pairs and segments (bytes).
    pub fn contact_bytes(&self) -> usize {
        8 * self.pairs.len() + 4 * self.impacts.len() + 24 * self.segments.len()
    }
}
