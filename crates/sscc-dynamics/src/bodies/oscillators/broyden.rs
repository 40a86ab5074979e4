//! Broyden's method: iterations that correct an approximate derivative by the changes of earlier iterations (Kelley 1995,
//! *Iterative Methods for Linear and Nonlinear Equations*, section 7.3).

/// Changes of the unknowns since the derivative was computed.
#[derive(Clone, Debug, Default)]
pub(crate) struct Broyden {
    /// Change of the unknowns in the next iteration.
    pub change: Vec<f64>,
    /// Changes of the iterations, one after the other.
    changes: Vec<f64>,
    /// Squared lengths of `changes`.
    squares: Vec<f64>,
}

impl Broyden {
    /// Discards the changes: a new derivative was computed.
    pub fn begin(&mut self) {
        self.changes.clear();
        self.squares.clear();
    }

    /// Improves `change`, as computed with the derivative, by the stored changes.
    pub fn improve(&mut self) {
        let r = self.change.len();
        let mut all = self.changes.chunks_exact(r).zip(&self.squares).peekable();
        while let Some((s, square)) = all.next() {
            let product: f64 = s.iter().zip(&self.change).map(|(s, z)| s * z).sum::<f64>() / square;
            match all.peek() {
                Some((next, _)) => self.change.iter_mut().zip(*next).for_each(|(z, s)| *z += product * s),
                None => self.change.iter_mut().for_each(|z| *z /= 1.0 - product),
            }
        }
    }

    /// Stores the change of an iteration that applied the fraction `share` of it.
    pub fn keep(&mut self, share: f64) {
        if share < 1.0 {
            self.begin();
        } else {
            self.changes.extend_from_slice(&self.change);
            self.squares.push(self.change.iter().map(|s| s * s).sum());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Broyden's method solves a linear system with a wrong derivative after twice as many iterations as it has unknowns (Gay
    /// 1979). The wrong derivative without corrections reduces the residual only to 0.005.
    #[test]
    fn linear_systems_are_solved() {
        let rows = [[2.0, 1.0, 0.0], [0.0, 3.0, 1.0], [1.0, 0.0, 2.0]];
        let (target, mut x) = ([1.0, -2.0, 0.5], [0.0; 3]);
        let residual = |x: &[f64; 3]| -> [f64; 3] {
            std::array::from_fn(|i| (0..3).map(|j| rows[i][j] * x[j]).sum::<f64>() - target[i])
        };
        let mut broyden = Broyden::default();
        broyden.begin();
        for _ in 0..7 {
            let left = residual(&x);
            broyden.change = (0..3).map(|i| -left[i] / rows[i][i]).collect();
            broyden.improve();
            (0..3).for_each(|i| x[i] += broyden.change[i]);
            broyden.keep(1.0);
        }
        assert!(residual(&x).iter().all(|left| left.abs() < 1e-9), "{:?}", residual(&x));
    }
}
