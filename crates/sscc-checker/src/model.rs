//! The model: faces, positions at rest, modes.

use crate::container::Container;
use crate::refusal::{Result, require};

/// The largest magnitude of coordinates, and of the entries of dense metrics, 2^200.
pub(crate) const LARGEST: f64 = f64::from_bits((1023 + 200) << 52);
/// The largest number of modes.
const MAX_MODES: usize = 1 << 20;

/// A mesh and its modes, with the numbers of the file.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) faces: Vec<[u32; 3]>,
    pub(crate) rank: usize,
    /// The component of mode k of a vertex is `modes[(3 vertex + component) rank + k]`.
    pub(crate) modes: Vec<f64>,
}

impl Model {
    /// Creates a model from positions at rest (V), faces (vertex numbers) and modes (3V x r by rows, three rows for a vertex).
    ///
    /// # Errors
    /// When there are no faces, no modes or more than 2^20, sizes do not fit each other, a face names a vertex that does not
    /// exist, or a number is not finite or beyond 2^200.
    pub fn new(positions: Vec<[f64; 3]>, faces: Vec<[u32; 3]>, modes: Vec<f64>, rank: usize) -> Result<Self> {
        let size = rank.checked_mul(3).and_then(|rows| rows.checked_mul(positions.len()));
        let fits = !faces.is_empty() && rank > 0 && size == Some(modes.len());
        require(fits, "model: it has no faces, no modes, or not three rows of modes for each vertex")?;
        require(rank <= MAX_MODES, "model: it has more than 2^20 modes")?;
        let has_vertices = faces.as_flattened().iter().all(|i| (*i as usize) < positions.len());
        require(has_vertices, "model: a face names a vertex that does not exist")?;
        let is_in_range = positions.as_flattened().iter().chain(&modes).all(|x| x.abs() <= LARGEST);
        require(is_in_range, "model: a number is not finite, or beyond 2^200")?;
        Ok(Self { positions, faces, rank, modes })
    }

    /// Parses a `*.model.safetensors` file.
    ///
    /// # Errors
    /// When the file is damaged, of another kind or version, or not a model.
    pub fn from_container(bytes: &[u8]) -> Result<Self> {
        let file = Container::parse(bytes, "sscc.model", 3)?;
        let positions: Vec<[f64; 3]> = file.reals("rest_positions", &[None, Some(3)])?.as_chunks().0.to_vec();
        let faces = file.integers("faces", &[None, Some(3)])?.as_chunks().0.to_vec();
        let modes = file.reals("modes", &[Some(positions.len()), Some(3), None])?;
        let rank = modes.len().checked_div(3 * positions.len()).unwrap_or(0);
        Self::new(positions, faces, modes, rank)
    }

    /// Returns the row of a vertex and a component.
    pub(crate) fn row(&self, vertex: usize, component: usize) -> &[f64] {
        &self.modes[(3 * vertex + component) * self.rank..][..self.rank]
    }

    /// Returns the position of a vertex at q as queries compute it: `x = p`, then `x += U_k q_k`, each product and sum rounded.
    pub(crate) fn computed_position(&self, vertex: usize, q: &[f64]) -> [f64; 3] {
        std::array::from_fn(|c| {
            self.row(vertex, c).iter().zip(q).fold(self.positions[vertex][c], |x, (u, q)| x + u * q)
        })
    }
}
