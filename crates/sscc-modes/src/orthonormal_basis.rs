//! Orthonormal basis to which vectors are added one by one.

/// Minimum new share of an independent vector. By rounding, a dependent one has about 1e-16; a second projection
/// restores the precision that is lost at a share of 1e-10.
const MIN_NEW_SHARE: f64 = 1e-10;

/// Orthonormal vectors under the inner product `<x, y> = sum_i weights[i] x[i] y[i]`.
///
/// Modified Gram-Schmidt, applied twice to each vector, which gives full precision (Giraud, Langou and Rozloznik 2005).
/// Vectors keep the order of insertion; each points along the new part of its original.
pub(crate) struct OrthonormalBasis {
    weights: Vec<f64>,
    /// Maximum length of a remainder that counts as noise.
    noise: f64,
    vectors: Vec<Vec<f64>>,
}

impl OrthonormalBasis {
    /// Creates an empty basis for vectors of `weights.len()` entries.
    pub fn new(weights: Vec<f64>, noise: f64) -> Self {
        Self { weights, noise, vectors: Vec::new() }
    }

    /// Returns the inner product. Entries of weight 0 do not count, even if they are infinite.
    pub fn dot(&self, x: &[f64], y: &[f64]) -> f64 {
        let mut sum = 0.0;
        for ((w, a), b) in self.weights.iter().zip(x).zip(y) {
            if *w > 0.0 {
                sum += w * a * b;
            }
        }
        sum
    }

    /// Adds the new part of `x`, scaled to length 1. Returns false, and adds nothing, if `x` depends on the vectors
    /// before it.
    pub fn add(&mut self, mut x: Vec<f64>) -> bool {
        let threshold = (MIN_NEW_SHARE * self.dot(&x, &x).sqrt()).max(self.noise);
        for _ in 0..2 {
            for e in &self.vectors {
                let along = self.dot(e, &x);
                for (x, e) in x.iter_mut().zip(e) {
                    *x -= along * e;
                }
            }
        }
        let new = self.dot(&x, &x).sqrt();
        if new <= threshold || !new.is_finite() {
            return false;
        }
        for x in &mut x {
            *x /= new;
        }
        self.vectors.push(x);
        true
    }

    /// Returns the vectors.
    pub fn vectors(&self) -> &[Vec<f64>] {
        &self.vectors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilbert_columns_become_orthonormal() {
        // The columns of a Hilbert matrix are nearly dependent: its condition at order 7 is 5e8.
        let n = 7;
        let weights: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let mut basis = OrthonormalBasis::new(weights, 0.0);
        for k in 0..n {
            assert!(basis.add((0..n).map(|i| 1.0 / (1.0 + (i + k) as f64)).collect()));
        }
        for (i, x) in basis.vectors().iter().enumerate() {
            for (j, y) in basis.vectors().iter().enumerate() {
                let wanted = if i == j { 1.0 } else { 0.0 };
                assert!((basis.dot(x, y) - wanted).abs() < 1e-14, "{i} {j}");
            }
        }
    }

    #[test]
    fn dependent_and_vanishing_vectors_are_not_added() {
        let mut basis = OrthonormalBasis::new(vec![1.0, 2.0, 0.0], 1e-12);
        assert!(basis.add(vec![1.0, 1.0, 1.0]));
        assert!(!basis.add(vec![3.0, 3.0, 5.0]), "differs only where the weight is 0");
        assert!(!basis.add(vec![0.0, 0.0, 0.0]));
        assert!(!basis.add(vec![1e-13, 0.0, 0.0]), "noise");
        assert!(basis.add(vec![0.0, 1e-6, f64::INFINITY]));
        assert_eq!(basis.vectors().len(), 2);
    }
}
