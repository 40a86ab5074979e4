//! Times at which an animation is answered.

use super::request::Times;

/// Maximum number of times. More indicate a mistake in the unit of the rate or of the animation.
const MAX_TIMES: f64 = 1e7;

/// A time that is closer to the last one than this share of a step counts as the last one.
const SAME: f64 = 1e-6;

impl Times {
    /// Returns the times of an animation that ends at `last_time` (s). There is at least one.
    ///
    /// # Errors
    /// A text with the cause: when a list is empty or has a time that is not finite; when a rate is not positive and
    /// finite, or gives too many times.
    pub fn of(&self, last_time: f64) -> Result<Vec<f64>, String> {
        let rate = match self {
            Self::List(times) => match times.iter().find(|time| !time.is_finite()) {
                Some(time) => return Err(format!("the time {time} is not finite")),
                None if times.is_empty() => return Err("there are no times".into()),
                None => return Ok(times.clone()),
            },
            Self::PerSecond(rate) => *rate,
        };
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(format!("{rate} frames per second: a finite number above 0 was expected"));
        }
        let last = last_time.max(0.0);
        let steps = (last * rate - SAME).ceil().max(0.0);
        if steps >= MAX_TIMES {
            return Err(format!("{steps:e} frames in {last} s: at most {MAX_TIMES:e} are allowed"));
        }
        let before = (0..steps as u64).map(|step| step as f64 / rate);
        Ok(before.chain([last]).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_included() {
        let times = |rate, last| Times::PerSecond(rate).of(last).unwrap();
        assert_eq!(times(2.0, 1.5), [0.0, 0.5, 1.0, 1.5]);
        assert_eq!(times(2.0, 1.25), [0.0, 0.5, 1.0, 1.25]);
        assert_eq!(times(30.0, 0.0), [0.0]);
        assert_eq!(times(30.0, -1.0), [0.0]);
        // 0.8333333 s as float32 is 20 steps of a 24th of a second, plus a rounding error.
        let rounded = times(24.0, f64::from(0.833_333_3_f32));
        assert_eq!((rounded.len(), rounded[20]), (21, f64::from(0.833_333_3_f32)));
        assert_eq!(times(30.0, 1.0).len(), 31);
    }

    #[test]
    fn bad_times_are_refused() {
        let message = |times: Times| times.of(10.0).unwrap_err();
        for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(message(Times::PerSecond(rate)).ends_with("a finite number above 0 was expected"));
        }
        assert_eq!(message(Times::PerSecond(1e9)), "1e10 frames in 10 s: at most 1e7 are allowed");
        assert_eq!(message(Times::List(vec![0.0, f64::NAN])), "the time NaN is not finite");
        assert_eq!(message(Times::List(Vec::new())), "there are no times");
        assert_eq!(Times::List(vec![2.0, 1.0]).of(0.0).unwrap(), [2.0, 1.0]);
    }
}
