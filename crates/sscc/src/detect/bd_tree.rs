//! The BD-tree (James and Pai 2004): AABBs that follow q at a cost of O(r) each, without touching vertices.

use super::aabb8::AabbF32;
use super::moving_modes::MovingModes;
use super::quantization::{CoarseMotion, Quantization};
use super::vertex_store::VertexStore;
use crate::ReducedModel;
use crate::geometry::Aabb;
use crate::hierarchy::Hierarchy;
use crate::model::rounding::larger_or_nan;
use crate::parallel;
use crate::vectors::{InstructionSet, Kernel, LANES, Vectors};
use glam::{DVec3, Vec4};

/// The number of components of a mean and a growth together.
const COMPONENTS: usize = 6;

/// The number of lanes of a vector beyond the components.
const PADDING: usize = LANES - COMPONENTS;

/// For each node with a BD-tree AABB the coefficients of its centre and half extents:
/// `centre(q) = c + sum_k mean_k q_k`, `half(q) = h + sum_k growth_k |q_k|`.
#[derive(Clone, Default)]
pub(crate) struct BdTree {
    /// The number of modes of each box, if they are not listed.
    rank: usize,
    /// For each node its index in the lists below; `u32::MAX` for a node without a box.
    indices: Vec<u32>,
    /// The modes that move each box.
    moving: MovingModes,
    /// `(c, h)` for each box.
    rest: Vec<(DVec3, DVec3)>,
    /// `(mean, growth)` for each mode of each box.
    rates: Vec<(DVec3, DVec3)>,
    /// Quantized `rest` and `rates`: `[(index * (rank + 1) + mode) * 6 + component]`, see [`Quantization`]; then two
    /// further entries. Only these two if the modes of boxes are listed.
    quantized: Vec<i16>,
    instructions: InstructionSet,
}

impl BdTree {
    /// Computes the boxes of the root and of all other nodes for which `is_wanted` holds.
    pub(crate) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        quantization: &Quantization,
        vertices: &VertexStore,
        is_wanted: impl Fn(u32) -> bool + Sync,
    ) -> Self {
        let (mesh, rank) = (model.mesh(), model.rank());
        let has = |n: usize| n == 0 || is_wanted(n as u32);
        let nodes: Vec<usize> = (0..hierarchy.nodes().len()).filter(|n| has(*n)).collect();
        let of_nodes: Vec<Vec<u32>> =
            parallel::map(&nodes, |n| hierarchy.vertices(&hierarchy.nodes()[*n], mesh.faces()));
        let in_store =
            |of_node: &Vec<u32>| -> Vec<u32> { of_node.iter().map(|v| vertices.index_of(*v)).collect() };
        let groups: Vec<Vec<u32>> = of_nodes.iter().map(in_store).collect();
        let moving = vertices.moving_modes().of_groups(&groups);
        let boxes = |(index, of_node): (usize, &Vec<u32>)| {
            rest_and_rates(model, of_node, &moving.of_item(index as u32).collect::<Vec<_>>())
        };
        let all: Vec<_> = parallel::map(of_nodes.iter().enumerate(), boxes);
        let mut next = 0..;
        let index = |n| if has(n) { next.next().unwrap_or(u32::MAX) } else { u32::MAX };
        let indices = (0..hierarchy.nodes().len()).map(index).collect();
        let mut quantized: Vec<i16> = Vec::with_capacity(all.len() * (rank + 1) * COMPONENTS + PADDING);
        for ((center, half), rates) in all.iter().filter(|_| !moving.are_listed()) {
            let means = quantization.quantize(*center, rates.iter().map(|rate| rate.0));
            let growths = quantization.quantize_extents(*half, rates.iter().map(|rate| rate.1));
            means.zip(growths).for_each(|(m, g)| quantized.extend([m, g].as_flattened()));
        }
        quantized.extend([0; PADDING]);
        let rest = all.iter().map(|(rest, _)| *rest).collect();
        let rates = all.into_iter().flat_map(|(_, rates)| rates).collect();
        Self { rank, indices, moving, rest, rates, quantized, instructions: InstructionSet::default() }
    }

    /// Returns a box that contains the computed positions of all vertices of a node at each q, hence all between them;
    /// `None` if the node has no box. `margin` covers rounding, along each axis: at least `(4 r + 64)` units of the last
    /// place of the shape's reach.
    pub(crate) fn at<const E: usize>(&self, node: u32, q: [&[f64]; E], margin: DVec3) -> Option<Aabb> {
        let index = self.indices[node as usize] as usize;
        (index < self.rest.len()).then(|| self.at_index(index, q, margin))
    }

    /// Returns the box in single precision, in the frame of the search; `None` if the node has no box, or the modes of
    /// boxes are listed.
    #[inline]
    pub(crate) fn coarse<const E: usize>(&self, node: u32, motion: &CoarseMotion<E>) -> Option<AabbF32> {
        let index = self.indices[node as usize] as usize;
        if index >= self.rest.len() || self.moving.are_listed() {
            return None;
        }
        let start = index * (self.rank + 1) * COMPONENTS;
        let quantized = &self.quantized[start..][..(self.rank + 1) * COMPONENTS + PADDING];
        let sums = self.instructions.run(MoveBox { quantized, motion });
        // Half extents are at least as large as at either end, since rounding is monotone, and hardly larger if the step is short.
        let half = sums.first().map_or(Vec4::ZERO, |[.., x, y, z, _, _]| Vec4::new(*x, *y, *z, 0.0));
        // Adds the error of the centre, and that of the half extents.
        let half = half + Vec4::splat(with_mutant!(2.0 * motion.error, CoarseNodesNotWidened, 0.0));
        let mut ends = sums.map(|[x, y, z, ..]| {
            let center = Vec4::new(x, y, z, 0.0);
            AabbF32 { lower: center - half, upper: center + half }
        });
        if let Some(maps) = &motion.maps {
            ends.iter_mut().zip(maps).for_each(|(aabb, map)| *aabb = map.apply_to_aabb(*aabb));
        }
        let join = |a: AabbF32, b: AabbF32| with_mutant!(a.union(&b), SweptCoarseNodesAtStart, a);
        ends.into_iter().reduce(join)
    }

    /// Returns the box of the whole shape.
    pub(crate) fn root<const E: usize>(&self, q: [&[f64]; E], margin: DVec3) -> Aabb {
        self.at_index(0, q, margin)
    }

    /// Returns an upper bound of the length of `sum_k U_k q_k` over all vertices of some nodes, up to rounding. Infinite if one of
    /// the nodes has no box, NaN if q is not finite.
    pub(crate) fn displacement_bound(&self, nodes: impl Iterator<Item = u32>, q: &[f64]) -> f64 {
        if !q.iter().all(|q| q.is_finite()) {
            return f64::NAN;
        }
        let mut most = 0.0_f64;
        for node in nodes {
            let index = self.indices[node as usize] as usize;
            if index >= self.rest.len() {
                return f64::INFINITY;
            }
            let (mut mean, mut growth) = (DVec3::ZERO, DVec3::ZERO);
            let rates = &self.rates[self.moving.range(index as u32)];
            for ((mean_rate, growth_rate), k) in rates.iter().zip(self.moving.of_item(index as u32)) {
                let q = q[k as usize];
                mean += *mean_rate * q;
                growth += *growth_rate * q.abs();
            }
            let growth = with_mutant!(growth, DisplacementsOfMeans, DVec3::ZERO);
            most = larger_or_nan(most, (mean.abs() + growth).length());
        }
        most
    }

    fn at_index<const E: usize>(&self, index: usize, q: [&[f64]; E], margin: DVec3) -> Aabb {
        let mut boxes = [self.rest[index]; E];
        let rates = &self.rates[self.moving.range(index as u32)];
        let mut add = |(mean, growth): &(DVec3, DVec3), q: [f64; E]| {
            for ((center, half), q) in boxes.iter_mut().zip(q) {
                *center += *mean * q;
                *half += *growth * q.abs();
            }
        };
        match self.moving.list(index as u32) {
            Some(list) => rates.iter().zip(list).for_each(|(rate, k)| add(rate, q.map(|q| q[*k as usize]))),
            None => {
                let q = q.map(|q| &q[..rates.len()]);
                rates.iter().enumerate().for_each(|(k, rate)| add(rate, q.map(|q| q[k])));
            }
        }
        let ends = boxes
            .map(|(center, half)| Aabb { lower: center - (half + margin), upper: center + (half + margin) });
        let join = |a: Aabb, b: Aabb| with_mutant!(a.union(&b), SweptNodesAtStart, a);
        ends.into_iter().reduce(join).unwrap_or_default()
    }
}

/// Returns centre and half extents of the AABB of some vertices at rest, and their mean and growth by each of some modes.
fn rest_and_rates(
    model: &ReducedModel,
    vertices: &[u32],
    moving: &[u32],
) -> ((DVec3, DVec3), Vec<(DVec3, DVec3)>) {
    let positions = vertices.iter().map(|v| model.mesh().rest_positions()[*v as usize]);
    let Aabb { lower, upper } = Aabb::of_points(positions);
    let center = lower * 0.5 + upper * 0.5;
    let mut rates = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); moving.len()];
    for v in vertices {
        let of_vertex = model.modes().of_vertex(*v);
        for ((least, greatest), k) in rates.iter_mut().zip(moving) {
            let u = of_vertex[*k as usize];
            *least = least.min(u);
            *greatest = greatest.max(u);
        }
    }
    for rate in &mut rates {
        let mean = rate.0 * 0.5 + rate.1 * 0.5;
        *rate = (mean, (rate.1 - mean).max(mean - rate.0));
    }
    ((center, (upper - center).max(center - lower)), rates)
}

/// The sums of the six quantized components of an AABB at each configuration of a motion.
struct MoveBox<'b, const E: usize> {
    quantized: &'b [i16],
    motion: &'b CoarseMotion<E>,
}

impl<const E: usize> Kernel for MoveBox<'_, E> {
    type Output = [[f32; LANES]; E];

    #[inline(always)]
    fn run<V: Vectors>(self, v: V) -> Self::Output {
        let Self { quantized, motion } = self;
        // These are loops, because maps of arrays are not inlined.
        let mut sums = [v.splat(0.0); E];
        for end in 0..E {
            let shift = motion.shift[end];
            sums[end] = v.load(&[shift.x, shift.y, shift.z, 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
        let mut components = quantized;
        for factors in &motion.node_factors {
            // The last two components belong to the next mode. If a mode is missing, NaN makes the box invalid.
            let Some(of_mode) = components.first_chunk::<LANES>() else { return [[f32::NAN; LANES]; E] };
            components = &components[COMPONENTS..];
            let of_mode = v.convert(of_mode);
            for end in 0..E {
                sums[end] = v.multiply_add(of_mode, v.load(&factors[end]), sums[end]);
            }
        }
        let mut all = [[0.0; LANES]; E];
        for end in 0..E {
            all[end] = v.array(sums[end]);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detect::f32_frame::F32Frame;
    use crate::detect::layout::{Layout, Needs};
    use crate::detect::vertex_motion::rounding_bound;
    use crate::detect::vertex_store::VertexStore;
    use crate::filter::PairFilter;
    use crate::{ContactFilter, Modes, TriMesh};

    /// Returns the next of fixed pseudo-random numbers in [-1, 1).
    fn random(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (*state >> 33) as f64 / 2.0_f64.powi(30) - 1.0
    }

    /// Returns a wavy strip far from the origin, with modes of very different sizes, each of which moves one of `every` vertices.
    fn model(rank: usize, every: usize, state: &mut u64) -> ReducedModel {
        let positions: Vec<DVec3> =
            (0..202).map(|i| DVec3::new(1e3 + (i / 2) as f64, (i % 2) as f64, random(state))).collect();
        let faces = (0..200).map(|i| [i, i + 1, i + 2]).collect();
        let displacements = (0..202 * rank)
            .map(|i| {
                let u =
                    DVec3::new(random(state), random(state), random(state)) * 10.0_f64.powi(i as i32 % 7 - 3);
                if (i / rank + i % rank).is_multiple_of(every) { u } else { DVec3::ZERO }
            })
            .collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        ReducedModel::new(mesh, Modes::new(rank, displacements).unwrap()).unwrap()
    }

    fn bits(boxes: &[AabbF32]) -> Vec<[u32; 8]> {
        let ends = |b: &AabbF32| [b.lower.to_array(), b.upper.to_array()];
        let bits = |b: &AabbF32| -> Vec<u32> { ends(b).as_flattened().iter().map(|x| x.to_bits()).collect() };
        boxes.iter().map(|b| bits(b).try_into().unwrap()).collect()
    }

    /// The motions are from one q to another, of all sizes and directions.
    #[test]
    fn boxes_contain_the_positions_at_both_ends() {
        let (mut state, mut coarse) = (8, 0);
        for case in 0..300 {
            let rank = [1, 2, 7, 30][case % 4];
            let model = model(rank, 1, &mut state);
            let hierarchy = Hierarchy::build(&model, model.metric());
            let vertices = VertexStore::new(&model, &(0..202).collect::<Vec<u32>>());
            let quantization = Quantization::new(&model, &vertices);
            let tree = BdTree::new(&model, &hierarchy, &quantization, &vertices, |_| true);
            let size = 10.0_f64.powi(case as i32 % 7 - 4);
            let mut random_q = || -> Vec<f64> { (0..rank).map(|_| random(&mut state) * size).collect() };
            let ends = [random_q(), random_q()];
            let ends = [&ends[0][..], &ends[1][..]];
            let reach = ends.iter().map(|q| model.check_coordinates(q).unwrap()).fold(0.0, f64::max);
            let rounding = rounding_bound(reach, rank);
            let frame = F32Frame::around(tree.root(ends, DVec3::splat(rounding)));
            let mut motion = CoarseMotion::default();
            if !quantization.begin(&mut motion, ends, &frame, rounding) {
                continue;
            }
            coarse += 1;
            let plain = BdTree { instructions: InstructionSet::Baseline, ..tree.clone() };
            for (n, node) in hierarchy.nodes().iter().enumerate() {
                let mapped = tree.coarse(n as u32, &motion).unwrap();
                // Both instruction sets give the same bits.
                assert_eq!(bits(&[mapped]), bits(&[plain.coarse(n as u32, &motion).unwrap()]));
                let Aabb { lower, upper } = tree.at(n as u32, ends, DVec3::splat(rounding)).unwrap();
                for v in hierarchy.vertices(node, model.mesh().faces()) {
                    for q in ends {
                        let x = model.position(v, q);
                        assert!(x.cmpge(lower).all() && x.cmple(upper).all(), "case {case}");
                        let x = frame.map(x);
                        let inside = x.cmpge(mapped.lower) & x.cmple(mapped.upper);
                        assert_eq!(inside.bitmask() & 0b111, 0b111, "case {case}");
                    }
                }
            }
        }
        assert!(coarse > 100, "{coarse}");
    }

    #[test]
    fn boxes_contain_all_computed_positions() {
        let mut state = 5;
        for (rank, every) in [(1, 1), (2, 1), (7, 1), (30, 1), (7, 3), (30, 5)] {
            let model = model(rank, every, &mut state);
            let hierarchy = Hierarchy::build(&model, model.metric());
            let vertices = VertexStore::new(&model, &(0..202).collect::<Vec<u32>>());
            let quantization = Quantization::new(&model, &vertices);
            let tree = BdTree::new(&model, &hierarchy, &quantization, &vertices, |n| {
                !hierarchy.nodes()[n as usize].is_leaf()
            });
            let (mut checked, mut coarse, mut wide) = (0, 0, 0.0_f32);
            for case in 0..200 {
                let size = 10.0_f64.powi(case % 25 - 12);
                let q: Vec<f64> = (0..rank).map(|_| random(&mut state) * size).collect();
                let reach = model.check_coordinates(&q).unwrap();
                let rounding = rounding_bound(reach, rank);
                let frame = F32Frame::around(tree.root([&q], DVec3::splat(rounding)));
                let mut motion = CoarseMotion::default();
                // A model whose modes move few vertices has no coarse boxes.
                let is_coarse = quantization.begin(&mut motion, [&q], &frame, rounding) && every == 1;
                coarse += usize::from(is_coarse);
                for (n, node) in hierarchy.nodes().iter().enumerate() {
                    let Some(Aabb { lower, upper }) = tree.at(n as u32, [&q], DVec3::splat(rounding)) else {
                        assert!(n != 0 && node.is_leaf() && tree.coarse(n as u32, &motion).is_none());
                        continue;
                    };
                    let mapped = tree.coarse(n as u32, &motion).filter(|_| is_coarse);
                    for v in hierarchy.vertices(node, model.mesh().faces()) {
                        let x = model.position(v, &q);
                        assert!(x.cmpge(lower).all() && x.cmple(upper).all(), "rank {rank}, case {case}");
                        checked += 1;
                        if let Some(mapped) = &mapped {
                            let x = frame.map(x);
                            let inside = x.cmpge(mapped.lower) & x.cmple(mapped.upper);
                            assert_eq!(inside.bitmask() & 0b111, 0b111, "rank {rank}, case {case}");
                        }
                    }
                    // Boxes in single precision are hardly larger than those in double precision.
                    if let Some(mapped) = mapped {
                        let larger = (frame.map(lower) - mapped.lower).max(mapped.upper - frame.map(upper));
                        wide = wide.max(larger.truncate().max_element() / motion.error);
                    }
                }
            }
            let is_as_many = if every > 1 { coarse == 0 } else { coarse > 50 };
            assert!(checked > 10_000 && is_as_many && wide < 4.0, "{checked} {coarse} {wide}");
        }
    }

    #[test]
    fn listed_modes_have_no_coarse_positions() {
        for every in [1, 5] {
            let model = model(10, every, &mut 3);
            let hierarchy = Hierarchy::build(&model, model.metric());
            let filter = PairFilter::new(&model, &ContactFilter::default());
            let layout = Layout::new(&model, &hierarchy, &filter, Needs::LAZY);
            assert_eq!(layout.coarse.is_empty(), every == 5);
        }
    }
}
