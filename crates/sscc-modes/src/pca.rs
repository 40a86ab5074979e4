//! Principal components of an animation.

use faer::linalg::matmul::triangular::{BlockStructure, matmul};
use faer::{Accum, Mat, Par};
use glam::DVec3;
use sscc::{Modes, Progress, TriMesh, limits};

use crate::ModesError;
use crate::cancel::check_cancelled;
use crate::eigen::dense::symmetric_eigen;
use crate::eigen::fix_signs;
use crate::orthonormal_basis::OrthonormalBasis;

/// Default share of the variance that the components explain.
const EXPLAINED_SHARE: f64 = 0.999;

/// Minimum variance of a component, relative to the largest: products of frames leave about 1e-15 for each frame.
const ZERO_TOLERANCE: f64 = 1e-12;

/// Maximum number of rows of frames, or positions of vertices, from one check for cancellation to the next.
const CHUNK: usize = 1 << 12;

/// Number of products of numbers between two checks for cancellation: less than a second.
const PRODUCTS_PER_CHECK: usize = 1 << 30;

/// Maximum of the number of frames or that of their coordinates, whichever is smaller. The decomposition of a matrix of
/// so many rows takes six matrices of 128 MiB, within 1 GiB, and minutes.
const MAX_ROWS: usize = 1 << 12;

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
/// Computes the eigenvectors of the Gram matrix (frames x frames) or of the covariance (coordinates x coordinates),
/// whichever is smaller. The same input gives the same bits, but other processors may round differently. Vertices that
/// coincide in all frames coincide in all modes.
///
/// # Errors
/// When there are fewer than two frames, or more than 4096 with more than 4096 coordinates each, one has another number
/// of vertices or a position out of range, all are equal, fewer independent directions exist than requested, or `rank`
/// is 0; when `progress` cancels.
pub fn pca_modes(
    mesh: &TriMesh,
    frames: &[Vec<DVec3>],
    rank: Option<usize>,
    progress: &dyn Progress,
) -> Result<Pca, ModesError> {
    let (vertices, used) = (mesh.rest_positions().len(), mesh.used_vertices());
    check(frames, vertices, 3 * used.len())?;
    let count = frames.len() as f64;
    // Sums relative to the first frame give the mean of equal positions exactly.
    let mean = |v: usize| {
        let sum: DVec3 = frames.iter().map(|frame| frame[v] - frames[0][v]).sum();
        frames[0][v] + sum / count
    };
    let mean: Vec<DVec3> = (0..vertices).map(mean).collect();
    let motion = Motion { used: &used, frames, mean: &mean };
    let (mut variances, vectors) = motion.decompose(progress)?;
    let total: f64 = variances.iter().map(|x| x.max(0.0)).sum();
    let threshold = (ZERO_TOLERANCE * variances[0]).max(motion.noise());
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
    let coordinates = motion.frame_coordinates(&vectors, rank, progress)?;
    let root = (count - 1.0).sqrt();
    let vertices_per_check = (CHUNK / frames.len()).max(1);
    let mut displacements = vec![DVec3::ZERO; vertices * rank];
    for (v, modes) in displacements.chunks_exact_mut(rank.max(1)).enumerate() {
        if v.is_multiple_of(vertices_per_check) {
            check_cancelled(progress)?;
        }
        for (frame, of_frame) in frames.iter().zip(coordinates.chunks_exact(rank.max(1))) {
            let moved = frame[v] - mean[v];
            modes.iter_mut().zip(of_frame).for_each(|(u, x)| *u += moved * (x / root));
        }
    }
    Ok(Pca {
        mesh: mesh.with_rest_positions(mean)?,
        modes: Modes::new(rank, displacements)?,
        deviations: variances.iter().map(|x| x.sqrt() / root).collect(),
        shares: variances.iter().map(|x| x / total).collect(),
    })
}

/// Returns an error for frames that do not fit a mesh with these numbers of vertices and of coordinates of used
/// vertices, or that are too many.
fn check(frames: &[Vec<DVec3>], vertices: usize, coordinates: usize) -> Result<(), ModesError> {
    if frames.len() < 2 {
        return Err(ModesError::TooFewFrames { found: frames.len() });
    }
    if frames.len().min(coordinates) > MAX_ROWS {
        return Err(ModesError::TooManyFrames { frames: frames.len(), coordinates, max: MAX_ROWS });
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

/// Displacements of all frames from their mean: a matrix of the coordinates of used vertices x frames.
struct Motion<'a> {
    used: &'a [u32],
    frames: &'a [Vec<DVec3>],
    mean: &'a [DVec3],
}

impl Motion<'_> {
    fn coordinates(&self) -> usize {
        3 * self.used.len()
    }

    /// Whether the covariance (coordinates x coordinates) is smaller than the Gram matrix (frames x frames). Both have
    /// the same positive eigenvalues.
    fn is_covariance_smaller(&self) -> bool {
        self.coordinates() < self.frames.len()
    }

    fn at(&self, coordinate: usize, frame: usize) -> f64 {
        let v = self.used[coordinate / 3] as usize;
        (self.frames[frame][v] - self.mean[v])[coordinate % 3]
    }

    /// Returns the eigenvalues, descending, of the smaller of both matrices, and its eigenvectors, in columns, ascending.
    fn decompose(&self, progress: &dyn Progress) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
        let is_covariance = self.is_covariance_smaller();
        let (coordinates, frames) = (self.coordinates(), self.frames.len());
        let (size, terms) = if is_covariance { (coordinates, frames) } else { (frames, coordinates) };
        let mut products: Mat<f64> = Mat::zeros(size, size);
        let chunk = (PRODUCTS_PER_CHECK / (size * size)).clamp(1, CHUNK);
        for begin in (0..terms).step_by(chunk) {
            progress.report(begin, 2 * terms);
            check_cancelled(progress)?;
            let part = Mat::from_fn(chunk.min(terms - begin), size, |row, column| {
                if is_covariance { self.at(column, begin + row) } else { self.at(begin + row, column) }
            });
            matmul(
                products.as_mut(),
                BlockStructure::TriangularLower,
                Accum::Add,
                part.transpose(),
                BlockStructure::Rectangular,
                &part,
                BlockStructure::Rectangular,
                1.0,
                Par::Seq,
            );
        }
        check_cancelled(progress)?;
        let (mut values, vectors) = symmetric_eigen(products.as_ref())?;
        check_cancelled(progress)?;
        values.reverse();
        Ok((values, vectors))
    }

    /// Returns a bound of the rounding error that positions leave in an eigenvalue.
    fn noise(&self) -> f64 {
        // Positions and the mean are each rounded by half a unit in the last place.
        let reach = self.used.iter().fold(0.0_f64, |m, v| m.max(self.mean[*v as usize].abs().max_element()));
        let rounding = f64::EPSILON * reach;
        self.coordinates() as f64 * self.frames.len() as f64 * rounding * rounding
    }

    /// Returns the unit frame coordinates of the strongest components (frames x rank, row-major): eigenvectors of the
    /// Gram matrix, the largest component of each positive. `vectors` are from [`Motion::decompose`].
    fn frame_coordinates(
        &self,
        vectors: &Mat<f64>,
        rank: usize,
        progress: &dyn Progress,
    ) -> Result<Vec<f64>, ModesError> {
        let frames = self.frames.len();
        let column = |k: usize| vectors.ncols() - 1 - k;
        let mut found: Mat<f64> = if self.is_covariance_smaller() {
            // Rounding errors of weak components are along strong ones, which the basis removes.
            let mut basis = OrthonormalBasis::new(vec![1.0; frames], 0.0);
            for k in 0..rank {
                check_cancelled(progress)?;
                let along = |frame: usize| -> f64 {
                    (0..self.coordinates()).map(|i| self.at(i, frame) * vectors[(i, column(k))]).sum()
                };
                basis.add((0..frames).map(along).collect());
            }
            // All are independent, because their variances exceed the rounding.
            Mat::from_fn(frames, rank, |frame, k| basis.vectors().get(k).map_or(0.0, |x| x[frame]))
        } else {
            Mat::from_fn(frames, rank, |frame, k| vectors[(frame, column(k))])
        };
        fix_signs(&mut found);
        Ok((0..frames * rank).map(|at| found[(at / rank, at % rank)]).collect())
    }
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
