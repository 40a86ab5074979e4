//! Sound of vibrating modes (paper, section 7: clattering): a bank of resonators that contact impulses excite.

use glam::DVec3;
use sscc::parts::vertex_areas;
use sscc::{Modes, TriMesh};

use crate::{Damping, DynamicsError, Impulse, LinearOscillator};

/// Audible modes of one body, advanced sample by sample; each mode is integrated exactly.
///
/// A sample is the sum over the modes of the rate of the mode times the root mean square, over the surface, of its
/// normal displacement. It measures the radiated sound without distance, direction or phase. The unit is model units
/// per second; scale samples to the range of the file format.
#[derive(Clone, Debug)]
pub struct SoundBank {
    resonators: LinearOscillator,
    /// Modes of each vertex: x of all modes, then y, then z, in single precision.
    modes: Vec<f32>,
    /// Loudness of each mode: root mean square of its normal displacement over the surface.
    weights: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    /// Change of each rate by the impulses since the last sample.
    pending: Vec<f32>,
    /// Forces of a free vibration (zeros).
    zero_forces: Vec<f64>,
}

impl SoundBank {
    /// Creates a bank from mass-orthonormal modes of a surface and their eigenvalues (r numbers, 1/s^2), at `rate`
    /// samples per second. Modes above half that rate are inaudible and omitted. Needs 12 bytes per vertex and mode.
    ///
    /// # Errors
    /// When modes, mesh and eigenvalues have different sizes, or the rate or the damping is outside its range.
    pub fn new(
        mesh: &TriMesh,
        modes: &Modes,
        eigenvalues: &[f64],
        damping: Damping,
        rate: f64,
    ) -> Result<Self, DynamicsError> {
        let (r, vertices) = (modes.rank(), mesh.rest_positions().len());
        if eigenvalues.len() != r || modes.vertices() != vertices {
            return Err(DynamicsError::Rank { found: eigenvalues.len(), rank: r });
        }
        let highest = std::f64::consts::PI * rate;
        let audible: Vec<usize> = (0..r).filter(|k| eigenvalues[*k] < highest * highest).collect();
        let eigenvalues: Vec<f64> = audible.iter().map(|k| eigenvalues[*k]).collect();
        let resonators = LinearOscillator::new(&eigenvalues, damping, 1.0 / rate)?;
        let mut modes_by_axis = Vec::with_capacity(3 * vertices * audible.len());
        for v in 0..vertices as u32 {
            let own = modes.of_vertex(v);
            for axis in 0..3 {
                modes_by_axis.extend(audible.iter().map(|k| own[*k][axis] as f32));
            }
        }
        let (areas, normals) = (vertex_areas(mesh), vertex_normals(mesh));
        let total_area: f64 = areas.iter().sum();
        let loudness = |k: &usize| {
            let square = |v: usize| areas[v] * modes.of_vertex(v as u32)[*k].dot(normals[v]).powi(2);
            ((0..vertices).map(square).sum::<f64>() / total_area).sqrt()
        };
        let weights: Vec<f64> = audible.iter().map(loudness).collect();
        let zeros = vec![0.0; audible.len()];
        Ok(Self {
            resonators,
            modes: modes_by_axis,
            weights,
            q: zeros.clone(),
            v: zeros.clone(),
            pending: vec![0.0; audible.len()],
            zero_forces: zeros,
        })
    }

    /// Returns the number of audible modes.
    pub fn modes(&self) -> usize {
        self.weights.len()
    }

    /// Applies an impulse to the surface, in axes of the rest pose. It acts at the next sample.
    pub fn strike(&mut self, impulse: &Impulse) {
        let r = self.pending.len();
        for (v, weight) in impulse.vertices.iter().zip(impulse.weights) {
            if weight == 0.0 {
                continue;
            }
            let force: [f32; 3] = (impulse.impulse * weight).to_array().map(|x| x as f32);
            let own = &self.modes[3 * r * *v as usize..][..3 * r];
            let (x, rest) = own.split_at(r);
            let (y, z) = rest.split_at(r);
            for (((pending, x), y), z) in self.pending.iter_mut().zip(x).zip(y).zip(z) {
                *pending += x * force[0] + y * force[1] + z * force[2];
            }
        }
    }

    /// Advances the bank by one sample and returns the sample.
    pub fn sample(&mut self) -> f64 {
        for (v, pending) in self.v.iter_mut().zip(&mut self.pending) {
            *v += f64::from(std::mem::take(pending));
        }
        self.resonators.advance(&mut self.q, &mut self.v, &self.zero_forces);
        self.v.iter().zip(&self.weights).map(|(v, w)| v * w).sum()
    }

    /// Returns the state (2 numbers per audible mode), from which [`SoundBank::restore`] continues.
    pub fn state(&self) -> Vec<f64> {
        [&self.q[..], &self.v].concat()
    }

    /// Restores a state of a bank with the same modes.
    ///
    /// # Errors
    /// When the state has another length.
    pub fn restore(&mut self, state: &[f64]) -> Result<(), DynamicsError> {
        let r = self.q.len();
        if state.len() != 2 * r {
            return Err(DynamicsError::State { found: state.len(), expected: 2 * r });
        }
        self.q.copy_from_slice(&state[..r]);
        self.v.copy_from_slice(&state[r..]);
        self.pending.fill(0.0);
        Ok(())
    }
}

/// Returns the unit normals of vertices: area-weighted means over their triangles.
fn vertex_normals(mesh: &TriMesh) -> Vec<DVec3> {
    let p = mesh.rest_positions();
    let mut normals = vec![DVec3::ZERO; p.len()];
    for face in mesh.faces() {
        let [a, b, c] = face.map(|v| p[v as usize]);
        let normal = (b - a).cross(c - a);
        face.iter().for_each(|v| normals[*v as usize] += normal);
    }
    normals.into_iter().map(DVec3::normalize_or_zero).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sscc_modes::shapes;

    /// Returns a spring with three modes; the frequency of the last one is above half the sample rate.
    fn bank(damping: Damping) -> SoundBank {
        let mesh = shapes::spring_of(60, 6);
        let p = mesh.rest_positions().to_vec();
        let modes =
            Modes::new(3, p.iter().flat_map(|p| [*p, DVec3::Z * p.x, DVec3::X * p.z]).collect()).unwrap();
        let eigenvalues = [440.0, 1000.0, 30_000.0].map(|f| (std::f64::consts::TAU * f).powi(2));
        SoundBank::new(&mesh, &modes, &eigenvalues, damping, 44_100.0).unwrap()
    }

    fn impulse_at_a_triangle(impulse: DVec3) -> Impulse {
        Impulse { body: 0, vertices: [3, 4, 5], weights: [0.5, 0.25, 0.25], impulse }
    }

    #[test]
    fn an_impulse_excites_the_frequencies_and_decays() {
        let mut damped = bank(Damping { mass: 10.0, stiffness: 0.0 });
        assert_eq!(damped.modes(), 2);
        assert_eq!(damped.sample(), 0.0);
        damped.strike(&impulse_at_a_triangle(DVec3::new(0.1, -0.2, 0.4)));
        let samples: Vec<f64> = (0..44_100).map(|_| damped.sample()).collect();
        let power = |hertz: f64, part: &[f64]| {
            let (mut re, mut im) = (0.0, 0.0);
            for (n, x) in part.iter().enumerate() {
                let phase = std::f64::consts::TAU * hertz * n as f64 / 44_100.0;
                re += x * libm::cos(phase);
                im += x * libm::sin(phase);
            }
            (re * re + im * im).sqrt()
        };
        let (early, late) = (&samples[..4410], &samples[39_690..]);
        for (mode, hertz) in [440.0, 1000.0].into_iter().enumerate() {
            // Amplitudes decay as e^(-5 t).
            let decay = power(hertz, late) / power(hertz, early);
            assert!((decay / libm::exp(-4.5) - 1.0).abs() < 0.05, "{decay}");
            // If only one mode is excited, its spectral peak is at its frequency.
            let mut bank = bank(Damping::default());
            bank.v[mode] = 1.0;
            let alone: Vec<f64> = (0..4410).map(|_| bank.sample()).collect();
            let (at, beside) = (power(hertz, &alone), power(hertz + 55.0, &alone));
            assert!(at > 5.0 * beside, "{at} and {beside}");
        }
    }

    #[test]
    fn a_restored_bank_continues_with_the_same_samples() {
        let mut bank = bank(Damping::default());
        bank.strike(&impulse_at_a_triangle(DVec3::X));
        for _ in 0..100 {
            bank.sample();
        }
        let state = bank.state();
        let expected: Vec<f64> = (0..100).map(|_| bank.sample()).collect();
        let mut other = bank.clone();
        other.restore(&state).unwrap();
        assert_eq!((0..100).map(|_| other.sample()).collect::<Vec<f64>>(), expected);
        assert!(other.restore(&state[1..]).is_err());
    }
}
