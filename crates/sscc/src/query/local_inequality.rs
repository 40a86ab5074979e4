//! The inequality of local certificates at the configurations of a search, and the bound of the ratios that it allows.
//!
//! A motion is proven at its two ends: the factors f, the map F and the image `W f` of the residual are linear along it, so that
//! `kappa |W f|` and the error terms are convex, at most the interpolation of their values at the ends; the bounds of
//! [`stretches_between`] are concave. In a region of radius b around the segment, F changes by at most `map b`, `W f` by `strain b` and
//! the sum of the factors by `sum b`: each is added to its own term. For a flat patch the image of the direction across errs as F does.

use glam::{DMat3, DVec3};

use super::affine_modes::{AffineFree, AffineModes};
use super::local_tables::LocalTables;
use super::smallest_stretch::{smallest_stretch, stretches_between};
use crate::certificates::{EllipsoidBlocks, FactorScales, GRADIENT, MOST_MODES, gradient_len};
use crate::detect::vertex_motion::{VertexMotion, rounding_bound};
use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};

/// The root of three, rounded up: errors are along each axis, gaps along any direction.
const DIAGONAL: f64 = 1.7321;

/// The affine part of a motion is subtracted if less than this share of the factors remains.
const MOST_LEFT: f64 = 0.5;

/// Rounds sums of non-negative numbers up, at most as many as the modes of a certificate. The sum over all modes may round by more
/// (2^-32 for 2^20 modes), but only scales error terms, of which each has half of its size in reserve.
const ROUND_UP: f64 = 1.0 + 1e-12;

/// Rounding of positions in the units of certificates: a difference and a product, two units u = 2^-53 each of at most 1 along each axis,
/// for two vertices in any direction: 7 u of 128. The rounding of factors and of scaled displacements (5 u of each term), and modes
/// whose size underflows to 0 (less than 2^-51 each), are within the rounding bound of positions, which allows `8 r + 128`
/// units where positions need `2 (r + 1)`.
const UNITS_ERROR: f64 = 64.0 * f64::EPSILON;

/// Underflow in single precision: at most 200 factors lose 2^-150 each, times a column below 1e12: less than 2e-31.
const UNDERFLOW: f64 = 1e-30;

/// The factors of one motion, and the error of its positions.
#[derive(Clone)]
pub(super) struct LocalInequality<const E: usize> {
    instructions: InstructionSet,
    ends: [Factors; E],
    /// The radius of the region in z around the segment between the configurations.
    radius: f64,
    /// `eta`: an upper bound of the error of the difference of two positions, in the units of the certificates.
    error: f64,
}

/// The factors of one configuration, without its affine part where that is subtracted (`affine_modes.rs`).
#[derive(Clone, Default)]
struct Factors {
    exact: AffineFree,
    /// The factors in single precision, padded with zeros.
    single: Vec<f32>,
    /// `T`, rounded up.
    sum: f64,
}

impl Factors {
    /// Sets the factors for q, and subtracts the part of the affine modes if given.
    fn set(&mut self, q: &[f64], tables: &LocalTables, affine: Option<&AffineModes>) {
        let offsets = q.iter().zip(&tables.center).map(|(q, c)| q - c);
        self.exact.set(offsets.zip(&tables.scales.sizes).map(|(offset, size)| offset * size));
        if let Some(affine) = affine {
            affine.take_from(&mut self.exact);
        }
        let factors = &self.exact.factors;
        self.single.clear();
        self.single.extend(factors.iter().map(|factor| *factor as f32));
        self.single.resize(factors.len().next_multiple_of(LANES), 0.0);
        self.sum = (self.exact.sum() + self.exact.error) * ROUND_UP;
    }
}

impl<const E: usize> LocalInequality<E> {
    /// Creates the inequality without a motion.
    pub(super) fn new() -> Self {
        Self {
            instructions: InstructionSet::default(),
            ends: std::array::from_fn(|_| Factors::default()),
            radius: 0.0,
            error: f64::INFINITY,
        }
    }

    /// Sets the factors of a motion. False if its positions are not those of the modes alone, or certificates prove nothing about it.
    pub(super) fn set_motion<M: VertexMotion<E>>(&mut self, tables: &LocalTables, motion: &M) -> bool {
        let (Some(coordinates), Some(radius)) = (motion.coarse_coordinates(), motion.region_radius()) else {
            return false;
        };
        self.radius = with_mutant!(radius, LocalProofsInRegions, 0.0);
        if with_mutant!(self.radius > 0.0 && tables.rates.is_none(), LocalRegionUnknown, false) {
            return false;
        }
        // The configurations must not be so far away that sums may overflow.
        let mut is_near = self.set_factors(tables, &coordinates, None);
        if let Some(affine) = &tables.affine {
            let whole = self.sum();
            is_near &= self.set_factors(tables, &coordinates, Some(affine));
            // If only a part of the shape moves, its motion has an affine part, too; subtracting it would make other parts seem to bend.
            if self.sum() >= MOST_LEFT * whole {
                self.set_factors(tables, &coordinates, None);
            }
        }
        let FactorScales { sizes, scale, reach } = &tables.scales;
        let rounding = motion.rounding() + rounding_bound(*reach, sizes.len());
        let error = 2.0 * DIAGONAL * ROUND_UP * rounding * scale + UNITS_ERROR;
        self.error = with_mutant!(error, LocalPositionsExact, 0.0, LocalErrorAlongAxes, error / DIAGONAL);
        self.error.is_finite() && is_near
    }

    /// Sets the factors of all configurations. False if one of them is too far away.
    fn set_factors(
        &mut self,
        tables: &LocalTables,
        coordinates: &[&[f64]; E],
        affine: Option<&AffineModes>,
    ) -> bool {
        self.ends.iter_mut().zip(coordinates).for_each(|(end, q)| end.set(q, tables, affine));
        self.ends.iter().all(|end| end.sum < 1e30)
    }

    /// Returns the sum of `T` over all configurations.
    fn sum(&self) -> f64 {
        self.ends.iter().map(|end| end.sum).sum()
    }

    /// Returns a bound of the ratio `kappa`: pairs of this certificate with a smaller ratio are proven free at all
    /// configurations. NaN if no ratio is proven.
    pub(super) fn allowed(&self, tables: &LocalTables, index: usize) -> f32 {
        let all = &*tables.certificates;
        let bounds = &all.bounds[index];
        let [start, end] = [index, index + 1].map(|i| all.mode_starts[i] as usize);
        let modes = &all.modes[start..end];
        let [gradient, ellipsoid] = tables.starts[index].map(|start| start as usize);
        let gradients = &all.gradients.as_chunks().0[gradient..][..gradient_len(modes.len()) / LANES];
        let ellipsoid =
            &all.ellipsoids.as_chunks().0[ellipsoid..][..EllipsoidBlocks(modes.len()).len() / LANES];
        let is_dense = modes.len() == tables.center.len();
        // The largest changes of the sum, the map and the strain within the radius.
        let [more_sum, more_map, more_strain] = match &tables.rates {
            Some(rates) if self.radius > 0.0 => {
                let of_certificate = rates.certificates[index];
                [
                    with_mutant!(rates.sum, LocalRegionSumStill, 0.0),
                    with_mutant!(of_certificate.map, LocalRegionMapStill, 0.0),
                    with_mutant!(of_certificate.strain, LocalRegionStrainStill, 0.0),
                ]
                .map(|rate| rate * self.radius)
            }
            _ => [0.0; 3],
        };
        // The relative error of sums of products in single precision, and of the factors.
        let single = 2.0 * (modes.len() as f64 + 4.0) * f64::from(f32::EPSILON);
        let at = |end: usize| {
            let Factors { exact, single: factors, sum } = &self.ends[end];
            let (mut gathered, mut sum) = ([0.0_f32; MOST_MODES], *sum);
            let factors = if is_dense {
                &**factors
            } else {
                let mut local = 0.0;
                for (g, k) in gathered.iter_mut().zip(modes) {
                    *g = factors[*k as usize];
                    local += f64::from(g.abs());
                }
                sum = sum.min((local + exact.error) * (1.0 + 1e-6) + UNDERFLOW);
                &gathered[..modes.len().next_multiple_of(LANES)]
            };
            sum += more_sum;
            let (gradient, strain) =
                self.instructions.run(Sums { gradients, ellipsoid, factors, count: modes.len() });
            let rounding = with_mutant!(single * bounds.widest * sum, LocalStrainExact, 0.0);
            let strain = strain
                + rounding
                + with_mutant!(bounds.widest * exact.error, LocalAffineStrainExact, 0.0)
                + more_strain
                + UNDERFLOW;
            let error = bounds.per_factor * sum
                + bounds.per_error
                    * (self.error + with_mutant!(exact.length, LocalAffineLengthForgotten, 0.0))
                + with_mutant!(single * bounds.steepest * sum, LocalMapExact, 0.0)
                + with_mutant!(bounds.steepest * exact.error + exact.map_error, LocalAffineMapExact, 0.0)
                + more_map
                + UNDERFLOW;
            let affine = with_mutant!(exact.map, LocalAffineMapForgotten, DMat3::ZERO);
            (DMat3::IDENTITY + affine + gradient, strain * ROUND_UP, error * ROUND_UP)
        };
        let ends: [(DMat3, f64, f64); E] = std::array::from_fn(at);
        let allowed = |stretches: [f64; E], lost: [f64; E]| {
            let each = ends.iter().zip(stretches).zip(lost).map(|(((_, strain, error), stretch), lost)| {
                (stretch - error - lost) / strain * (1.0 - 1e-12)
            });
            each.fold(f64::INFINITY, smaller)
        };
        let maps = ends.map(|(map, _, _)| map);
        let plain = allowed(stretches_of(&maps), [0.0; E]);
        if bounds.flatness == f64::INFINITY {
            return (plain as f32).next_down();
        }
        // The error of the map is also an error of its image of the direction across. The new map is rounded, too.
        let (maps, turned) = flat_maps(&maps, DVec3::from_array(bounds.across));
        let lost = std::array::from_fn(|end| {
            (bounds.flatness + 1e-14)
                * (turned[end] + with_mutant!(ends[end].2, LocalPlaneMapExact, 0.0))
                * ROUND_UP
        });
        let flat = allowed(stretches_of(&maps), with_mutant!(lost, LocalPlaneTurnsAlong, [0.0; E]));
        // If the result is NaN, no ratio is allowed.
        (if flat > plain { flat } else { plain } as f32).next_down()
    }
}

/// Returns lower bounds of the smallest stretches of maps, as [`stretches_between`].
fn stretches_of<const E: usize>(maps: &[DMat3; E]) -> [f64; E] {
    if E == 1 { maps.map(|map| smallest_stretch(&map)) } else { stretches_between(maps) }
}

/// Replaces the image of the direction across a flat patch in all maps by the same unit vector, which is perpendicular to the image of
/// the plane by the mean of the maps. Also returns the distances of this vector from the original images.
fn flat_maps<const E: usize>(maps: &[DMat3; E], across: DVec3) -> ([DMat3; E], [f64; E]) {
    let mean = maps.iter().fold(DMat3::ZERO, |sum, map| sum + *map);
    let (x, y) = across.any_orthonormal_pair();
    let image = (mean * x).cross(mean * y).normalize_or_zero();
    let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
    let turned = maps.map(|map| (map * across - image).length());
    (maps.map(|map| map + outer(image - map * across, across)), turned)
}

/// Returns the smaller of two numbers, and NaN if one is NaN, which allows no ratio.
fn smaller(a: f64, b: f64) -> f64 {
    with_mutant!(if a < b || a.is_nan() { a } else { b }, LocalSweptNanIgnored, a.min(b))
}

/// The number of SIMD vectors in the longest column of W.
const MOST_VECTORS: usize = MOST_MODES.div_ceil(LANES);

/// Computes `G f`, and the norm of `W f` up to the rounding of single precision, for the numbers of one certificate.
struct Sums<'c> {
    gradients: &'c [[f32; LANES]],
    ellipsoid: &'c [[u16; LANES]],
    factors: &'c [f32],
    count: usize,
}

impl Kernel for Sums<'_> {
    type Output = (DMat3, f64);

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> Self::Output {
        let Self { gradients, ellipsoid, factors, count } = self;
        let (columns, last) = gradients.split_at(count);
        let mut gradient = [vectors.splat(0.0); 2];
        for (k, (column, factor)) in columns.iter().zip(factors).enumerate() {
            gradient[k & 1] =
                vectors.multiply_add(vectors.load(column), vectors.splat(*factor), gradient[k & 1]);
        }
        let mut ninth = vectors.splat(0.0);
        for (row, factors) in last.iter().zip(factors.as_chunks().0) {
            ninth = vectors.multiply_add(vectors.load(row), vectors.load(factors), ninth);
        }
        let mut image = [[0.0_f32; LANES]; MOST_VECTORS];
        let mut blocks = ellipsoid;
        for (first, image) in (0..count).step_by(LANES).zip(&mut image) {
            let (rows, rest) = blocks.split_at(count - first);
            blocks = rest;
            let mut sums = [vectors.splat(0.0); 2];
            for (i, (column, factor)) in rows.iter().zip(&factors[first..]).enumerate() {
                let column = vectors.load_upper_halves(column);
                sums[i & 1] = vectors.multiply_add(column, vectors.splat(*factor), sums[i & 1]);
            }
            let one = vectors.splat(1.0);
            *image = vectors.array(vectors.multiply_add(sums[0], one, sums[1]));
        }
        let [even, odd] = gradient.map(|sum| vectors.array(sum));
        let entry = |e: usize| f64::from(even[e]) + f64::from(odd[e]);
        let ninth = vectors.array(ninth).iter().map(|x| f64::from(*x)).sum();
        let map = DMat3::from_cols(
            DVec3::new(entry(0), entry(1), entry(2)),
            DVec3::new(entry(3), entry(4), entry(5)),
            DVec3::new(entry(6), entry(7), ninth),
        );
        let used = &image[..count.div_ceil(LANES)];
        let square: f64 = used.as_flattened().iter().map(|x| f64::from(*x) * f64::from(*x)).sum();
        (map, square.sqrt() * ROUND_UP)
    }
}

const _: () = assert!(GRADIENT == LANES + 1);

#[cfg(test)]
mod tests;
