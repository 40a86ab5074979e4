//! `Query::resolve`: a free configuration near a colliding one.
//!
//! The search begins at the last free configuration on the straight way from a free start to q, and steps back towards q.
//! Pairs that intersect have no separating direction, but at a free configuration every near pair has one, and while this
//! direction separates the pair q is in a few half-spaces ([`separations`](super::separations)). A step goes to the
//! nearest point to q within the half-spaces of all pairs that are in the way ([`projection`](super::projection)). These
//! pairs come from a continuous query from here to there: its impacts add half-spaces until there are none. Then
//! the step is free, and its end is checked once more by a discrete query. At the end the directions are those of other
//! closest points, so another step can come nearer to q. The search ends when no step does.

use super::answer::{ResolveOptions, Resolved};
use super::walk::Walk;
use crate::Error;
use crate::query::query::Query;

fn env(name: &str, default: &str) -> Vec<f64> {
    std::env::var(name).unwrap_or(default.into()).split(',').map(|x| x.parse().unwrap()).collect()
}

impl Query<'_> {
    pub fn resolve(&mut self, q: &[f64], options: &ResolveOptions) -> Result<Resolved, Error> {
        self.context.model.check_coordinates(q)?;
        let start = match &options.start {
            Some(start) => start.clone(),
            None => self.context.scope.center.clone(),
        };
        self.context.model.check_coordinates(&start)?;
        let mut walk = Walk::new(self, q, start.clone(), options.all);
        if walk.is_free(q)? {
            return Ok(Resolved::free(q));
        }
        if !walk.is_free(&start)? {
            return if options.start.is_some() { Err(Error::ResolveStart) } else { Ok(Resolved::NONE) };
        }
        let mut best: Option<(f64, Vec<f64>)> = None;
        let mut safe_scale_change = f64::INFINITY;
        for share in env("SHARES", "0.9") {
            walk.q = start.clone();
            safe_scale_change = walk.approach(share)?;
            let way: Vec<f64> = q.iter().zip(&walk.q).map(|(t, q)| t - q).collect();
            let scale = walk.query.context.model.displacement_bound(&way);
            for margin in env("MARGINS", "1e-1,1e-2,1e-3,1e-5") {
                for i in 0..env("STEPS", "30")[0] as usize {
                    let before = walk.distance();
                    walk.step(margin * scale)?;
                    let after = walk.distance();
                    if std::env::var("TRACE").is_ok() {
                        eprintln!("share {share} margin {margin:e} step {i}: {before} -> {after}");
                    }
                    if after > before * (1.0 - env("GAIN", "1e-3")[0]) {
                        break;
                    }
                }
            }
            let change = walk.distance();
            if best.as_ref().is_none_or(|best| change < best.0) {
                best = Some((change, walk.q.clone()));
            }
        }
        let (change, there) = best.unwrap();
        Ok(Resolved { q: Some(there), change, safe_scale_change })
    }
}
