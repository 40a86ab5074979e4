//! Principal components of an animation.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, Par};
use glam::DVec3;
use sscc::{Modes, Progress, TriMesh, limits};

use crate::ModesError;
use crate::cancel::check_cancelled;
use crate::diagonalize::eigen;

/// Default share of the variance that the components explain.
const EXPLAINED_SHARE: f64 = 0.999;

/// Minimum variance of a component, relative to the largest: products of frames leave about 1e-15 for each frame.
const ZERO_TOLERANCE: f64 = 1e-12;

/// Number of rows of frames, or vertices, per task.
const CHUNK: usize = 1 << 12;

/// The mean of an animation, and the principal components about it: see [`pca_modes`].
#[derive(Clone, Debug, PartialEq)]
pub struct Pca {
    /// The mean of all frames, with the given faces.
    pub mesh: TriMesh,
    /// The principal directions, the strongest first, each times its standard deviation: q counts standard deviations.
    /// The largest of a mode's frame coordinates is positive.
    pub modes: Modes,
    /// The standard deviation along each unit direction (model unit; n - 1 in the denominator).
    pub deviations: Vec<f64>,
    /// Share of the total variance that each mode explains.
    pub shares: Vec<f64>,
}

/// Principal component analysis of frames with common topology: `frame = mean + U q`, exactly (up to rounding) for all
/// frames if `rank` is the number of independent directions.
///
/// The inner product is the plain sum over the vertices that some face uses, as usual for animations: where the mesh
/// is finer, motion counts more. `mesh` gives the faces; its positions are not used. Frames hold one position for each
/// of its vertices. `rank` is the number of components; None gives as many as explain 99.9% of the variance. There are
/// fewer components than frames.
///
/// Computes the eigenvectors of the Gram matrix (frames x frames). The same input gives the same bits, but other
/// processors may round differently. Vertices that coincide in all frames coincide in all modes.
///
/// # Errors
/// When there are fewer than two frames, one has another number of vertices or a position out of range, all are equal,
/// fewer independent directions exist than requested, or `rank` is 0; when `progress` cancels.
pub fn pca_modes(
    mesh: &TriMesh,
    frames: &[Vec<DVec3>],
    rank: Option<usize>,
    progress: &dyn Progress,
) -> Result<Pca, ModesError> {
    let vertices = mesh.rest_positions().len();
    check(frames, vertices)?;
    let count = frames.len() as f64;
    // Sums relative to the first frame give the mean of equal positions exactly.
    let mean = |v: usize| {
        let sum: DVec3 = frames.iter().map(|frame| frame[v] - frames[0][v]).sum();
        frames[0][v] + sum / count
    };
    let mean: Vec<DVec3> = (0..vertices).map(mean).collect();
    let (mut variances, vectors, noise) = components(&mesh.used_vertices(), frames, &mean, progress)?;
    variances.reverse();
    let total: f64 = variances.iter().map(|x| x.max(0.0)).sum();
    let threshold = (ZERO_TOLERANCE * variances[0]).max(noise);
    let available = variances.iter().take(frames.len() - 1).take_while(|x| **x > threshold).count();
    let rank = match rank {
        _ if available == 0 => return Err(ModesError::StillFrames { frames: frames.len() }),
        Some(requested) if requested > available => {
            return Err(ModesError::TooManyComponents { requested, available });
        }
        Some(requested) => requested,
        None => explaining(EXPLAINED_SHARE * total, &variances[..available]),
    };
    variances.truncate(rank);

    // U_k = sum_t (frame_t - mean) v_tk / sqrt(n - 1): the length of the sum is the root of the eigenvalue.
    let last = frames.len() - 1;
    let root = (last as f64).sqrt();
    let mut displacements = vec![DVec3::ZERO; vertices * rank];
    for (v, modes) in displacements.chunks_exact_mut(rank.max(1)).enumerate() {
        if v.is_multiple_of(CHUNK) {
            check_cancelled(progress)?;
        }
        for (frame, of_frame) in frames.iter().zip(vectors.chunks_exact(frames.len())) {
            let moved = frame[v] - mean[v];
            modes.iter_mut().enumerate().for_each(|(k, u)| *u += moved * (of_frame[last - k] / root));
        }
    }
    Ok(Pca {
        mesh: mesh.with_rest_positions(mean)?,
        modes: Modes::new(rank, displacements)?,
        deviations: variances.iter().map(|x| x.sqrt() / root).collect(),
        shares: variances.iter().map(|x| x / total).collect(),
    })
}

/// Returns an error for frames that do not fit a mesh with this number of vertices.
fn check(frames: &[Vec<DVec3>], vertices: usize) -> Result<(), ModesError> {
    if frames.len() < 2 {
        return Err(ModesError::TooFewFrames { found: frames.len() });
    }
    for (index, frame) in frames.iter().enumerate() {
        if frame.len() != vertices {
            return Err(ModesError::FrameVertices { frame: index, found: frame.len(), expected: vertices });
        }
        if let Some(vertex) = frame.iter().position(|p| !limits::contains(*p)) {
            return Err(ModesError::FramePosition { frame: index, vertex });
        }
    }
    Ok(())
}

/// Returns the eigenvalues, ascending, and eigenvectors (T x T, row-major, in columns) of the frames' Gram matrix about
/// their mean, and a bound of the rounding error that positions leave in an eigenvalue.
fn components(
    used: &[u32],
    frames: &[Vec<DVec3>],
    mean: &[DVec3],
    progress: &dyn Progress,
) -> Result<(Vec<f64>, Vec<f64>, f64), ModesError> {
    let moved = |row: usize, frame: usize| {
        let v = used[row / 3] as usize;
        (frames[frame][v] - mean[v])[row % 3]
    };
    let count = frames.len();
    let (rows, mut gram) = (3 * used.len(), Mat::zeros(count, count));
    for begin in (0..rows).step_by(CHUNK) {
        progress.report(begin, 2 * rows);
        check_cancelled(progress)?;
        let centred = Mat::from_fn(CHUNK.min(rows - begin), count, |row, frame| moved(begin + row, frame));
        matmul(
            gram.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            centred.transpose(),
            BlockStructure::Rectangular,
            &centred,
            BlockStructure::Rectangular,
            1.0,
            Par::Seq,
        );
    }
    let whole: Vec<f64> = (0..count * count)
        .map(|at| (at / count, at % count))
        .map(|(i, j)| gram[(i.max(j), i.min(j))])
        .collect();
    check_cancelled(progress)?;
    let (values, vectors) = eigen(count, &whole)?;
    // Positions and the mean are each rounded by half a unit in the last place.
    let reach = used.iter().fold(0.0_f64, |m, v| m.max(mean[*v as usize].abs().max_element()));
    let rounding = f64::EPSILON * reach;
    Ok((values, vectors, 3.0 * used.len() as f64 * count as f64 * rounding * rounding))
}

/// Returns the number of largest variances whose sum is at least `wanted`; all if none is.
fn explaining(wanted: f64, variances: &[f64]) -> usize {
    let mut sum = 0.0;
    let reached = variances.iter().position(|x| {
        sum += x;
        sum >= wanted
    });
    reached.map_or(variances.len(), |last| last + 1)
}
