//! Sound of modes (paper, section 7: clattering): a bank of resonators that contact impulses strike.

use glam::DVec3;
use sscc::{Modes, TriMesh, vertex_areas};

use crate::{Damping, DynamicsError, Impulse, LinearOscillator};

/// The vibrations of one body that are heard, advanced sample by sample, each one exactly.
///
/// A sample is the velocity of the surface along its normal: of each mode the root mean square over the surface,
/// times the rate of the mode. That is a measure of what it radiates, without distance, direction or phase. In model
/// units per second; scale it to what a file can hold.
#[derive(Clone, Debug)]
pub struct SoundBank {
    resonators: LinearOscillator,
    /// Of each vertex, x of all modes, then y, then z: single precision, side by side.
    modes: Vec<f32>,
    weights: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    struck: Vec<f32>,
    silence: Vec<f64>,
}

impl SoundBank {
    /// Mass-orthonormal modes of a surface, with their eigenvalues (1/s^2), heard at `rate` samples a second. Modes
    /// above half that rate cannot be heard, and are left out.
    ///
    /// # Errors
    /// When modes, mesh and eigenvalues do not fit, or the rate or the damping cannot be.
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
        let heard: Vec<usize> = (0..r).filter(|k| eigenvalues[*k] < highest * highest).collect();
        let eigenvalues: Vec<f64> = heard.iter().map(|k| eigenvalues[*k]).collect();
        let resonators = LinearOscillator::new(&eigenvalues, damping, 1.0 / rate)?;
        let mut side_by_side = Vec::with_capacity(3 * vertices * heard.len());
        for v in 0..vertices as u32 {
            let own = modes.of_vertex(v);
            for axis in 0..3 {
                side_by_side.extend(heard.iter().map(|k| own[*k][axis] as f32));
            }
        }
        let (areas, normals) = (vertex_areas(mesh), vertex_normals(mesh));
        let whole: f64 = areas.iter().sum();
        let loudness = |k: &usize| {
            let square = |v: usize| areas[v] * modes.of_vertex(v as u32)[*k].dot(normals[v]).powi(2);
            ((0..vertices).map(square).sum::<f64>() / whole).sqrt()
        };
        let weights: Vec<f64> = heard.iter().map(loudness).collect();
        let zeros = vec![0.0; heard.len()];
        Ok(Self {
            resonators,
            modes: side_by_side,
            weights,
            q: zeros.clone(),
            v: zeros.clone(),
            struck: vec![0.0; heard.len()],
            silence: zeros,
        })
    }

    /// How many modes are heard.
    pub fn modes(&self) -> usize {
        self.weights.len()
    }

    /// An impulse on the surface, in axes of the rest pose.
    pub fn strike(&mut self, impulse: &Impulse) {
        let r = self.struck.len();
        for (v, weight) in impulse.vertices.iter().zip(impulse.weights) {
            if weight == 0.0 {
                continue;
            }
            let force: [f32; 3] = (impulse.impulse * weight).to_array().map(|x| x as f32);
            let own = &self.modes[3 * r * *v as usize..][..3 * r];
            let (x, rest) = own.split_at(r);
            let (y, z) = rest.split_at(r);
            for (((struck, x), y), z) in self.struck.iter_mut().zip(x).zip(y).zip(z) {
                *struck += x * force[0] + y * force[1] + z * force[2];
            }
        }
    }

    /// The next sample.
    pub fn sample(&mut self) -> f64 {
        for (v, struck) in self.v.iter_mut().zip(&mut self.struck) {
            *v += f64::from(std::mem::take(struck));
        }
        self.resonators.advance(&mut self.q, &mut self.v, &self.silence);
        self.v.iter().zip(&self.weights).map(|(v, w)| v * w).sum()
    }

    /// All that changes from sample to sample: for going on later.
    pub fn state(&self) -> Vec<f64> {
        [&self.q[..], &self.v].concat()
    }

    /// Takes up a state of a bank of the same modes.
    ///
    /// # Errors
    /// When it is of another length.
    pub fn restore(&mut self, state: &[f64]) -> Result<(), DynamicsError> {
        let r = self.q.len();
        if state.len() != 2 * r {
            return Err(DynamicsError::State { found: state.len(), expected: 2 * r });
        }
        self.q.copy_from_slice(&state[..r]);
        self.v.copy_from_slice(&state[r..]);
        self.struck.fill(0.0);
        Ok(())
    }
}

/// Normals of vertices (length 1): the mean of those of their triangles, by area.
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

    /// A spring with three modes: the last one too high to be heard.
    fn bank(damping: Damping) -> SoundBank {
        let mesh = shapes::spring_of(60, 6);
        let p = mesh.rest_positions().to_vec();
        let modes =
            Modes::new(3, p.iter().flat_map(|p| [*p, DVec3::Z * p.x, DVec3::X * p.z]).collect()).unwrap();
        let eigenvalues = [440.0, 1000.0, 30_000.0].map(|f| (std::f64::consts::TAU * f).powi(2));
        SoundBank::new(&mesh, &modes, &eigenvalues, damping, 44_100.0).unwrap()
    }

    fn blow(impulse: DVec3) -> Impulse {
        Impulse { body: 0, vertices: [3, 4, 5], weights: [0.5, 0.25, 0.25], impulse }
    }

    #[test]
    fn a_blow_rings_at_the_frequencies_and_dies_away() {
        let mut damped = bank(Damping { mass: 10.0, stiffness: 0.0 });
        assert_eq!(damped.modes(), 2);
        assert_eq!(damped.sample(), 0.0);
        damped.strike(&blow(DVec3::new(0.1, -0.2, 0.4)));
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
            // Amplitudes fall by e^(-5 t).
            let decay = power(hertz, late) / power(hertz, early);
            assert!((decay / libm::exp(-4.5) - 1.0).abs() < 0.05, "{decay}");
            // Struck alone: its power is where its frequency is.
            let mut bank = bank(Damping::default());
            bank.v[mode] = 1.0;
            let alone: Vec<f64> = (0..4410).map(|_| bank.sample()).collect();
            let (at, beside) = (power(hertz, &alone), power(hertz + 55.0, &alone));
            assert!(at > 5.0 * beside, "{at} and {beside}");
        }
    }

    #[test]
    fn a_bank_goes_on_from_its_state() {
        let mut bank = bank(Damping::default());
        bank.strike(&blow(DVec3::X));
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
