//! Validation of local certificates that were read from a file, against their hierarchy.
//!
//! This checks every index that a query takes from them, and that each number is in the range of computed ones. It does
//! not check whether the numbers are proofs: the file's hash shows that no byte was changed.

use std::ops::Range;

use super::local_certificates::{EllipsoidBlocks, LocalBounds, LocalCertificates, MOST_MODES, gradient_len};
use crate::hierarchy::Hierarchy;
use crate::vectors::LANES;

impl LocalCertificates {
    /// Checks that the certificates fit a valid hierarchy and a number of modes.
    ///
    /// # Errors
    /// If they do not fit.
    pub(crate) fn check(&self, hierarchy: &Hierarchy, rank: usize) -> Result<(), &'static str> {
        if self.nodes.is_empty() {
            let is_empty = *self == Self::default();
            return if is_empty { Ok(()) } else { Err("they have numbers, but no nodes") };
        }
        self.check_modes(rank)?;
        self.check_numbers()?;
        self.check_nodes(hierarchy)
    }

    fn check_modes(&self, rank: usize) -> Result<(), &'static str> {
        let (mut gradients, mut ellipsoids) = (0_usize, 0_usize);
        for range in ranges(&self.mode_starts, self.nodes.len(), self.modes.len())
            .ok_or("modes of certificates are out of order")?
        {
            let modes = &self.modes[range];
            if modes.len() > MOST_MODES {
                return Err("a certificate has too many modes");
            }
            if !modes.is_sorted_by(|a, b| a < b) || modes.last().is_some_and(|k| *k as usize >= rank) {
                return Err("modes of a certificate are out of order, or do not exist");
            }
            gradients = gradients.saturating_add(gradient_len(modes.len()));
            ellipsoids = ellipsoids.saturating_add(EllipsoidBlocks(modes.len()).len());
        }
        if (self.gradients.len(), self.ellipsoids.len()) != (gradients, ellipsoids) {
            return Err("gradients or ellipsoids are not those of their modes");
        }
        let are_addressed = [gradients, ellipsoids].into_iter().all(is_addressed);
        if are_addressed { Ok(()) } else { Err("they have more numbers than their indices can address") }
    }

    fn check_numbers(&self) -> Result<(), &'static str> {
        if self.gradients.iter().any(|x| !x.is_finite()) {
            return Err("a gradient is not finite");
        }
        // The exponent of infinity and NaN.
        if self.ellipsoids.iter().any(|half| half & 0x7f80 == 0x7f80) {
            return Err("an ellipsoid is not finite");
        }
        if self.bounds.len() != self.nodes.len() {
            return Err("the number of bounds is not the number of certificates");
        }
        for LocalBounds { ratio, per_factor, per_error, steepest, widest, across, flatness } in &self.bounds {
            let finite = [per_factor, per_error, steepest, widest];
            let is_finite = finite.iter().all(|x| (0.0..f64::INFINITY).contains(*x));
            let is_direction = across.iter().map(|x| x * x).sum::<f64>() <= 1.0 + 1e-12;
            let are_ratios = [ratio, flatness].iter().all(|x| **x >= 0.0);
            if !(are_ratios && is_finite && is_direction) {
                return Err("a bound is out of range");
            }
        }
        if self.list_ratios.iter().any(|ratio| ratio.is_nan() || *ratio < 0.0) {
            return Err("a ratio is negative or not a number");
        }
        Ok(())
    }

    fn check_nodes(&self, hierarchy: &Hierarchy) -> Result<(), &'static str> {
        let (nodes, within) = (hierarchy.nodes(), hierarchy.nodes_within_buckets());
        // Nodes are ascending, so the last one is the largest.
        let are_nodes = |list: &[u32]| {
            list.is_sorted_by(|a, b| a < b)
                && list.last().is_none_or(|n| (*n as usize) < nodes.len())
                && list.iter().all(|n| !within[*n as usize])
        };
        if !are_nodes(&self.nodes) {
            return Err("nodes are out of order, do not exist, or are inside a bucket");
        }
        let triangles = |n: u32| {
            let node = nodes[n as usize];
            node.first_triangle..node.first_triangle + node.triangle_count
        };
        if self.list_ratios.len() != self.list_nodes.len() {
            return Err("the number of ratios is not the number of nodes in lists");
        }
        let lists = ranges(&self.list_starts, self.nodes.len(), self.list_nodes.len())
            .ok_or("lists of certificates are out of order")?;
        for (n, range) in self.nodes.iter().zip(lists) {
            let list = &self.list_nodes[range];
            if !are_nodes(list) {
                return Err("nodes of a list are out of order, do not exist, or are inside a bucket");
            }
            let own = triangles(*n);
            let is_apart = |other: Range<u32>| other.end <= own.start || own.end <= other.start;
            if !list.iter().all(|m| is_apart(triangles(*m))) {
                return Err("a node of a list has triangles of the certificate's node");
            }
        }
        Ok(())
    }
}

/// Returns the ranges between `count` starts and the end. None if the starts do not ascend from 0 to that end.
fn ranges(starts: &[u32], count: usize, end: usize) -> Option<impl Iterator<Item = Range<usize>>> {
    let is_whole = starts.len() == count + 1 && starts[0] == 0 && starts[count] as usize == end;
    let ranges = starts.windows(2).map(|pair| pair[0] as usize..pair[1] as usize);
    (is_whole && starts.is_sorted()).then_some(ranges)
}

/// Whether the starts in a list of this many numbers fit into the 32 bits in which queries store them.
fn is_addressed(count: usize) -> bool {
    with_mutant!(u32::try_from(count / LANES).is_ok(), LocalAddressesUnlimited, true)
}

#[cfg(test)]
mod tests;
