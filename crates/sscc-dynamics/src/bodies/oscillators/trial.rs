//! Trials of the nonlinear integrator for the end of a step.

/// Trial acceleration, and the state at the end of the step with this acceleration.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trial {
    pub acceleration: Vec<f64>,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    /// `C v`.
    pub damping_forces: Vec<f64>,
    /// Left side of the equation of motion minus the right side.
    pub residual: Vec<f64>,
    /// Sum of the absolute values of the residual; infinite where it is not a number.
    pub residual_sum: f64,
    /// Sum of the absolute values of all terms of the residual.
    pub term_sum: f64,
    /// Elastic energy at q, where the residual was computed from an evaluation.
    pub elastic_energy: f64,
}

impl Trial {
    /// Computes the residual from the inner forces and the forces g.
    pub fn set_residual(&mut self, inner: impl Iterator<Item = f64>, g: &[f64]) {
        self.residual.clear();
        (self.residual_sum, self.term_sum) = (0.0, 0.0);
        for (((inner, b), damping), g) in inner.zip(&self.acceleration).zip(&self.damping_forces).zip(g) {
            let residual = b + damping + inner - g;
            self.residual_sum += residual.abs();
            self.term_sum += b.abs() + damping.abs() + inner.abs() + g.abs();
            self.residual.push(residual);
        }
        if self.residual_sum.is_nan() {
            self.residual_sum = f64::INFINITY;
        }
    }

    /// Copies the state to q, v and the undamped acceleration.
    pub fn finish(&self, q: &mut [f64], v: &mut [f64], undamped: &mut [f64]) {
        q.copy_from_slice(&self.q);
        v.copy_from_slice(&self.v);
        let accelerations = self.acceleration.iter().zip(&self.damping_forces);
        undamped.iter_mut().zip(accelerations).for_each(|(e, (b, damping))| *e = b + damping);
    }
}
