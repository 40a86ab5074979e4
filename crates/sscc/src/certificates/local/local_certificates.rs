//! The numbers of local certificates.
//!
//! A node N with nodes around it is a *patch*. About the centre `q_0` of the certificates, in the unit of half the size of
//! the shape, its vertices are at `x_v = p_v + U_v f`. The factor `f_k = (q - q_0)_k s_k` is the coordinate in units in which
//! mode k moves a vertex by at most 1; `s_k` is the largest displacement by mode k. Take any gradient G (a 3 x 3 matrix for each
//! mode) and its residuals `E_v = U_v - U_0 - G (p_v - p_0)`. Then for two vertices
//!
//! ```text
//! x_j - x_i = F (p_j - p_i) + (E_j - E_i) f,    F = I + G f
//! ```
//!
//! For two triangles take a unit direction n with `s_ij = n.(p_j - p_i) > 0` at all nine pairs of corners. Along
//! `m = F^-T n` the gap of two corners is `s_ij + m.(E_j - E_i) f`, and `|m| <= 1 / sigma_min(F)`. So the plane across m
//! separates the triangles if `|(E_j - E_i) f| < sigma_min(F) s_ij` at all nine. One matrix W for all pairs of the patch, and
//! for each set of pairs of triangles a *ratio* `kappa` with `|(E_j - E_i) f| <= s_ij (kappa |W f| + rho T)` and
//! `T = sum_k |f_k|`, make this one comparison:
//!
//! ```text
//! kappa |W f| + rho T + eta / s  <  sigma_min(F)
//! ```
//!
//! where s is the smallest `s_ij`, and eta bounds how far computed positions are from the exact ones.
//!
//! A patch that is nearly flat does not determine the map across its plane: the map of least norm does not rotate with the patch,
//! and F becomes singular where the patch rotates by a right angle. Let a be the direction across, and `nu` any vector, best a
//! unit vector across the image of the plane. With `F~ = F (I - a a') + nu a'` in place of F,
//!
//! ```text
//! x_j - x_i = F~ (p_j - p_i) + (E_j - E_i) f + (F a - nu) (a.(p_j - p_i))
//! ```
//!
//! So `kappa |W f| + phi |F a - nu| + rho T + eta / s < sigma_min(F~)` suffices, too, if `|a.(p_j - p_i)| <= phi s_ij`. The
//! searches for kappa and phi may accept one pair along different directions n and n', with gaps s and s'. For `A = kappa |W f|`
//! and `B = phi |F a - nu|` the direction `(A n + B n') / (A + B)`, of length at most 1, serves for both: its gap is
//! `(A s + B s') / (A + B)`, at least the smaller of both, which is why eta and rho are over the smallest gap of both searches.
//!
//! A certificate has a ratio for the pairs within N, and one for the pairs of N with each node of its list, which are nodes that share a vertex
//! with it. It proves nothing about two other nodes of the patch. Pairs that do not count and exceptions are in none of the
//! sets.

/// Local certificates of the nodes of a hierarchy, as many as their budget allows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LocalCertificates {
    /// The node of each certificate, ascending.
    pub nodes: Vec<u32>,
    /// Where the modes of each certificate start, and the end. Nothing is stored for modes that do not move a patch.
    pub mode_starts: Vec<u32>,
    /// The modes of each certificate, ascending.
    pub modes: Vec<u32>,
    /// The gradients of each certificate: for each of its modes eight entries of G column by column, then the ninth of all its
    /// modes, padded with zeros to a multiple of eight.
    pub gradients: Vec<f32>,
    /// W of each certificate, upper triangular; each number is the upper half of a single-precision one. For each eight rows it
    /// has their parts of all columns from the diagonal of the first row on.
    pub ellipsoids: Vec<u16>,
    /// The numbers of the comparison of each certificate.
    pub bounds: Vec<LocalBounds>,
    /// Where the list of each certificate starts, and the end.
    pub list_starts: Vec<u32>,
    /// The nodes of each list, ascending.
    pub list_nodes: Vec<u32>,
    /// The ratio of the pairs of the certificate's node with each node of its list; infinite if none was found.
    pub list_ratios: Vec<f32>,
}

/// The numbers of a certificate's comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalBounds {
    /// The ratio `kappa` of the pairs within the node; infinite if none was found.
    pub ratio: f64,
    /// `rho`: the error of residuals and of their images.
    pub per_factor: f64,
    /// `1 / s`, where s counts as at most 1, rounded up.
    pub per_error: f64,
    /// The largest Frobenius norm of a mode's gradient, rounded up: the error of F in single precision is within a multiple of
    /// it.
    pub steepest: f64,
    /// The largest norm of a column of W, rounded up: the error of `W f` is within a multiple of it.
    pub widest: f64,
    /// `a`, a direction across a patch that is nearly flat; zero for other patches.
    pub across: [f64; 3],
    /// `phi`, which bounds `|a.(p_j - p_i)| / s_ij` of all pairs; infinite if a patch is not flat.
    pub flatness: f64,
}

impl Default for LocalBounds {
    /// Returns zeros, for a patch that is not flat.
    fn default() -> Self {
        Self {
            ratio: 0.0,
            per_factor: 0.0,
            per_error: 0.0,
            steepest: 0.0,
            widest: 0.0,
            across: [0.0; 3],
            flatness: f64::INFINITY,
        }
    }
}

/// A patch has no certificate if more modes than this move it.
pub(crate) const MOST_MODES: usize = 200;

/// Certificates that cover less than this share of a shape take more time than they save (docs/notes/local-certificates.md).
pub(crate) const LEAST_PROVEN_SHARE: f64 = 0.6;

/// The number of entries of the gradient of one mode.
pub(crate) const GRADIENT: usize = 9;

/// The number of numbers in a vector.
const LANES: usize = crate::vectors::LANES;

/// The layout of an upper triangular matrix in blocks of eight rows and one column.
#[derive(Clone, Copy)]
pub(crate) struct EllipsoidBlocks(pub(crate) usize);

impl EllipsoidBlocks {
    /// Returns for each eight rows the columns that have entries in them.
    pub(crate) fn columns(self) -> impl Iterator<Item = std::ops::Range<usize>> {
        (0..self.0).step_by(LANES).map(move |first| first..self.0)
    }

    /// Returns how many numbers a matrix has.
    pub(crate) fn len(self) -> usize {
        LANES * self.columns().map(|columns| columns.len()).sum::<usize>()
    }
}

/// Returns how many numbers the gradients of this many modes have.
pub(crate) fn gradient_len(modes: usize) -> usize {
    LANES * (modes + modes.div_ceil(LANES))
}

impl LocalCertificates {
    /// Returns the memory in bytes of a certificate of this many modes, apart from its list.
    pub(crate) fn bytes_of(modes: usize) -> usize {
        4 * gradient_len(modes) + 2 * EllipsoidBlocks(modes).len() + 4 * modes + size_of::<LocalBounds>() + 12
    }

    /// Returns the part of the memory that [`CertifyOptions::local_budget`](crate::CertifyOptions::local_budget) limits, in
    /// bytes: it leaves out the ends of lists.
    pub fn budgeted_bytes(&self) -> usize {
        let ends = self.mode_starts.len() + self.list_starts.len() - 2 * self.nodes.len();
        self.bytes() - 4 * ends
    }

    /// Returns the memory in bytes.
    pub fn bytes(&self) -> usize {
        let words = self.nodes.len()
            + self.mode_starts.len()
            + self.modes.len()
            + self.gradients.len()
            + self.list_starts.len()
            + 2 * self.list_nodes.len();
        4 * words + 2 * self.ellipsoids.len() + size_of_val(&*self.bounds)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Certificates of nine modes, one and none, with five nodes in their lists.
    #[test]
    fn bytes_are_those_of_all_lists() {
        let counts = [9, 1, 0];
        let ellipsoids: usize = counts.iter().map(|count| EllipsoidBlocks(*count).len()).sum();
        let local = LocalCertificates {
            nodes: vec![0; 3],
            mode_starts: vec![0; 4],
            modes: vec![0; 10],
            gradients: vec![0.0; counts.iter().map(|count| gradient_len(*count)).sum()],
            ellipsoids: vec![0; ellipsoids],
            bounds: vec![LocalBounds::default(); 3],
            list_starts: vec![0; 4],
            list_nodes: vec![0; 5],
            list_ratios: vec![0.0; 5],
        };
        let words = [&local.nodes, &local.mode_starts, &local.modes, &local.list_starts, &local.list_nodes];
        let numbers = size_of_val(&*local.gradients) + size_of_val(&*local.list_ratios);
        let expected = words.iter().map(|words| size_of_val(words.as_slice())).sum::<usize>()
            + numbers
            + size_of_val(&*local.ellipsoids)
            + size_of_val(&*local.bounds);
        assert_eq!(local.bytes(), expected);
        // The ends of both lists of starts are left out.
        assert_eq!(local.budgeted_bytes(), expected - 8);
        let of_certificates: usize = counts.iter().map(|count| LocalCertificates::bytes_of(*count)).sum();
        assert_eq!(local.budgeted_bytes(), of_certificates + 8 * local.list_nodes.len());
    }
}
