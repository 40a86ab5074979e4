//! Writes the frames of a mesh (`--frames-out`).

use std::path::Path;

use anyhow::{Result, ensure};
use sscc_io::NpyWriter;
use sscc_sim::DetectionAnswer;

/// The frames of one mesh, written as answers come (`--frames-out`).
pub struct FramesOut<'a> {
    path: &'a Path,
    writer: Option<NpyWriter>,
}

impl<'a> FramesOut<'a> {
    pub fn new(path: &'a Path) -> Self {
        Self { path, writer: None }
    }

    /// Writes the frame of an answer; that of the last one also where it ends.
    pub fn add(&mut self, found: &DetectionAnswer<'_>) -> Result<()> {
        let Some(shape) = found.shape else { return Ok(()) };
        let each = found.frames - usize::from(!shape.x_t1.is_empty());
        let writer = match &mut self.writer {
            Some(writer) => writer,
            writer => {
                ensure!(
                    found.queries == each,
                    "{}: several nodes have a mesh: name one by --node, or of a file at rest as FILE#NODE",
                    self.path.display()
                );
                let shape = [found.frames, found.mesh.rest_positions().len(), 3];
                writer.insert(NpyWriter::create(self.path, &shape)?)
            }
        };
        let is_last = found.index + 1 == each;
        for frame in [Some(shape.x_t0), is_last.then_some(shape.x_t1)].into_iter().flatten() {
            let values: Vec<f64> = frame.iter().flat_map(|x| x.to_array()).collect();
            writer.push(&values)?;
        }
        Ok(())
    }

    /// Completes the file.
    pub fn finish(self) -> Result<()> {
        self.writer.map_or(Ok(()), NpyWriter::finish).map_err(Into::into)
    }
}
