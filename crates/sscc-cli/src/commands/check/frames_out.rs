//! Writes the frames of a mesh (`--frames-out`).

use std::path::Path;

use anyhow::{Result, ensure};
use glam::DVec3;
use sscc_io::{NpyWriter, VtkFramesWriter, is_collection};
use sscc_tasks::DetectionAnswer;

use super::shapes;

/// The frames of one mesh, written as answers come (`--frames-out`).
pub struct FramesOut<'a> {
    path: &'a Path,
    writer: Option<Writer>,
}

enum Writer {
    Npy(NpyWriter),
    /// A collection of VTK, with times and marks.
    Vtk(VtkFramesWriter),
}

impl<'a> FramesOut<'a> {
    pub fn new(path: &'a Path) -> Self {
        Self { path, writer: None }
    }

    /// Writes the frame of an answer; the last answer of a motion also gives the frame at its end.
    pub fn add(&mut self, found: &DetectionAnswer<'_>) -> Result<()> {
        let Some(shape) = found.shape else { return Ok(()) };
        let each = found.frames - usize::from(!shape.x_t1.is_empty());
        let writer = match &mut self.writer {
            Some(writer) => writer,
            writer => {
                ensure!(
                    found.queries == each,
                    "{}: several nodes have a mesh: name one by --node, or for a file at rest as FILE#NODE",
                    self.path.display()
                );
                let (frames, most) = (found.frames, VtkFramesWriter::MAX_FRAMES);
                ensure!(
                    frames <= most || !is_collection(self.path),
                    "{}: a collection has at most {most} frames, but there are {frames}: write fewer, or write a .npy file",
                    self.path.display()
                );
                let shape = [found.frames, found.mesh.rest_positions().len(), 3];
                writer.insert(match is_collection(self.path) {
                    true => Writer::Vtk(VtkFramesWriter::create(self.path)?),
                    false => Writer::Npy(NpyWriter::create(self.path, &shape)?),
                })
            }
        };
        let is_last = found.index + 1 == each;
        let frames: [Option<&[DVec3]>; 2] = [Some(shape.x_t0), is_last.then_some(shape.x_t1)];
        for (at, frame) in frames.into_iter().enumerate() {
            let Some(frame) = frame.filter(|frame| !frame.is_empty()) else { continue };
            match writer {
                Writer::Npy(writer) => {
                    let values: Vec<f64> = frame.iter().flat_map(|x| x.to_array()).collect();
                    writer.push(&values)?;
                }
                Writer::Vtk(writer) => {
                    let index = found.index + at;
                    let time = found.frame_times.map_or(index as f64, |times| times[index]);
                    writer.push(time, found.mesh, frame, &shapes::marks(found.mesh, found.pairs))?;
                }
            }
        }
        Ok(())
    }

    /// Completes the file.
    pub fn finish(self) -> Result<()> {
        match self.writer {
            Some(Writer::Npy(writer)) => Ok(writer.finish()?),
            Some(Writer::Vtk(writer)) => Ok(writer.finish()?),
            None => Ok(()),
        }
    }
}
