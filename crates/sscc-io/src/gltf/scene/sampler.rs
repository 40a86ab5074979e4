//! Interpolation between the key frames of one property of a node.

use std::sync::Arc;

use glam::DQuat;

use super::rotation::{slerp, unit_or_identity};

/// Interpolation of a property between two key frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Interpolation {
    Step,
    Linear,
    CubicSpline,
}

impl Interpolation {
    /// Returns the interpolation of this name; LINEAR is the default.
    pub fn from_name(name: Option<&str>) -> Option<Self> {
        Some(match name {
            None | Some("LINEAR") => Self::Linear,
            Some("STEP") => Self::Step,
            Some("CUBICSPLINE") => Self::CubicSpline,
            Some(_) => return None,
        })
    }

    /// Number of items for one key frame: its value, and for splines the tangents before and after it.
    pub fn items_per_key(self) -> usize {
        if self == Self::CubicSpline { 3 } else { 1 }
    }
}

/// Key frames of one property.
pub(super) struct Sampler {
    /// Times of the key frames (s), ascending, at least one. Channels share them.
    pub times: Arc<[f64]>,
    /// Items of `width` numbers, [`Interpolation::items_per_key`] for each time.
    pub values: Vec<f64>,
    pub width: usize,
    pub interpolation: Interpolation,
}

/// Position of a time among the key frames.
enum At {
    /// The value is that of this key frame.
    Key(usize),
    /// Between a key frame and the next: the share of the segment that has passed, and its duration (s).
    Between { key: usize, share: f64, duration: f64 },
}

impl Sampler {
    /// Returns the value at a time (s), `width` numbers. Times outside the key frames count as the first or last.
    pub fn values_at(&self, time: f64) -> Vec<f64> {
        let blend = |from: &[f64], to: &[f64], share: f64| {
            from.iter().zip(to).map(|(a, b)| a * (1.0 - share) + b * share).collect()
        };
        match self.locate(time) {
            At::Key(key) => self.value(key).to_vec(),
            At::Between { key, share, duration } => match self.interpolation {
                Interpolation::Step => self.value(key).to_vec(),
                Interpolation::Linear => blend(self.value(key), self.value(key + 1), share),
                Interpolation::CubicSpline => self.spline(key, share, duration),
            },
        }
    }

    /// Returns the rotation at a time (s), a unit quaternion; `width` must be 4. The identity stands for a quaternion of
    /// length 0, which a spline can pass.
    pub fn rotation_at(&self, time: f64) -> DQuat {
        match self.locate(time) {
            At::Between { key, share, .. } if self.interpolation == Interpolation::Linear => {
                slerp(self.value(key), self.value(key + 1), share)
            }
            _ => unit_or_identity(&self.values_at(time)),
        }
    }

    /// Returns the values of all key frames in order, without tangents.
    pub fn key_values(&self) -> impl Iterator<Item = &[f64]> {
        (0..self.times.len()).map(|key| self.value(key))
    }

    fn locate(&self, time: f64) -> At {
        let after = self.times.partition_point(|key| *key <= time);
        match (after.checked_sub(1), self.times.get(after)) {
            (None, _) => At::Key(0),
            (Some(key), None) => At::Key(key),
            (Some(key), Some(next)) => {
                let duration = next - self.times[key];
                At::Between { key, share: (time - self.times[key]) / duration, duration }
            }
        }
    }

    /// Returns an item of a key frame: number 0 is its value; for splines 0 is the tangent before it, 1 the value, 2 the
    /// tangent after it.
    fn item(&self, key: usize, number: usize) -> &[f64] {
        &self.values[(key * self.interpolation.items_per_key() + number) * self.width..][..self.width]
    }

    fn value(&self, key: usize) -> &[f64] {
        self.item(key, self.interpolation.items_per_key() / 2)
    }

    /// Evaluates the cubic Hermite spline between a key frame and the next (appendix C of the format).
    fn spline(&self, key: usize, t: f64, duration: f64) -> Vec<f64> {
        let (t2, t3) = (t * t, t * t * t);
        let (from, to) = (2.0 * t3 - 3.0 * t2 + 1.0, -2.0 * t3 + 3.0 * t2);
        let (leaving, arriving) = (duration * (t3 - 2.0 * t2 + t), duration * (t3 - t2));
        let [v0, b0, a1, v1] =
            [self.value(key), self.item(key, 2), self.item(key + 1, 0), self.value(key + 1)];
        (0..self.width).map(|c| from * v0[c] + leaving * b0[c] + to * v1[c] + arriving * a1[c]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampler(interpolation: Interpolation, times: &[f64], width: usize, values: &[f64]) -> Sampler {
        assert_eq!(values.len(), times.len() * width * interpolation.items_per_key());
        Sampler { times: times.into(), values: values.into(), width, interpolation }
    }

    #[test]
    fn steps_hold_the_last_key_frame_and_lines_interpolate() {
        let step = sampler(Interpolation::Step, &[1.0, 2.0, 4.0], 1, &[10.0, 20.0, 40.0]);
        let line = sampler(Interpolation::Linear, &[1.0, 2.0, 4.0], 1, &[10.0, 20.0, 40.0]);
        for (time, held, between) in [
            (f64::NEG_INFINITY, 10.0, 10.0),
            (0.0, 10.0, 10.0),
            (1.0, 10.0, 10.0),
            (1.75, 10.0, 17.5),
            (2.0, 20.0, 20.0),
            (3.0, 20.0, 30.0),
            (4.0, 40.0, 40.0),
            (f64::INFINITY, 40.0, 40.0),
        ] {
            assert_eq!((step.values_at(time), line.values_at(time)), (vec![held], vec![between]), "{time}");
        }
        // Of key frames with equal times, the last one holds from that time on.
        let jump = sampler(Interpolation::Linear, &[0.0, 1.0, 1.0, 2.0], 1, &[0.0, 1.0, 5.0, 6.0]);
        assert_eq!([0.5, 1.0, 1.5].map(|t| jump.values_at(t)[0]), [0.5, 5.0, 5.5]);
        let single = sampler(Interpolation::CubicSpline, &[1.0], 1, &[7.0, 8.0, 9.0]);
        assert_eq!([0.0, 1.0, 2.0].map(|t| single.values_at(t)[0]), [8.0; 3]);
    }

    /// A spline reproduces any cubic polynomial with its derivatives as tangents.
    #[test]
    fn splines_are_cubic() {
        let at = |t: f64| [1.0 - t + 2.0 * t * t + 0.5 * t * t * t, t * t * t - 3.0];
        let slope = |t: f64| [-1.0 + 4.0 * t + 1.5 * t * t, 3.0 * t * t];
        let times = [-1.0, 0.5, 4.0];
        let values: Vec<f64> = times.iter().flat_map(|t| [slope(*t), at(*t), slope(*t)]).flatten().collect();
        let spline = sampler(Interpolation::CubicSpline, &times, 2, &values);
        for step in 0..=50 {
            let t = -1.0 + 0.1 * f64::from(step);
            let (found, expected) = (spline.values_at(t), at(t));
            assert!((found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12, "{t}");
        }
        assert_eq!(spline.values_at(9.0), at(4.0));
    }

    #[test]
    fn rotations_are_normalized() {
        // The ends of a line are exact for keys of any length.
        let long = sampler(Interpolation::Linear, &[0.0, 1.0], 4, &[0.0, 0.0, 0.0, 3.0, 0.0, 1.2, 0.0, 1.6]);
        assert_eq!(long.rotation_at(0.0), DQuat::IDENTITY);
        assert!((long.rotation_at(1.0) - DQuat::from_xyzw(0.0, 0.6, 0.0, 0.8)).length() < 1e-15);
        assert!((long.rotation_at(0.5).length() - 1.0).abs() < 1e-15);
        // Steps and splines are normalized after interpolation.
        let step = sampler(Interpolation::Step, &[0.0, 1.0], 4, &[0.0, 0.0, 0.0, 2.0, 3.0, 0.0, 0.0, 0.0]);
        assert_eq!(step.rotation_at(0.5), DQuat::IDENTITY);
        let zero = [0.0; 4];
        let keys = [zero, [0.0, 0.0, 0.0, 1.0], zero, zero, [1.0, 0.0, 0.0, 0.0], zero].concat();
        let spline = sampler(Interpolation::CubicSpline, &[0.0, 1.0], 4, &keys);
        assert!(
            (spline.rotation_at(0.5) - DQuat::from_xyzw(0.5_f64.sqrt(), 0.0, 0.0, 0.5_f64.sqrt())).length()
                < 1e-15
        );
        let through_zero = [zero, [0.0, 0.0, 0.0, 1.0], zero, zero, [0.0, 0.0, 0.0, -1.0], zero].concat();
        let spline = sampler(Interpolation::CubicSpline, &[0.0, 1.0], 4, &through_zero);
        assert_eq!(spline.rotation_at(0.5), DQuat::IDENTITY);
    }
}
