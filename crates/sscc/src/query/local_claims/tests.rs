//! Compares each claim of a local certificate with exact tests, at the largest scale at which it holds.

use glam::{DMat3, DVec3};
use sscc_testing::{FlexibleShape, Numbers, Shape, cases, threshold};

use crate::hierarchy::{Node, NodePair};
use crate::model::ScaledModel;
use crate::query::capsule_motion::{CapsuleMotion, CapsuleRates};
use crate::{
    Certificates, CertifyOptions, ContactFilter, KineticQuery, Method, Metric, MetricKind, Modes, Neighbours,
    Pair, Query, ReducedModel, TriMesh,
};

fn model_of(shape: &FlexibleShape) -> ReducedModel {
    let mesh = TriMesh::new(shape.positions.clone(), shape.faces.clone()).unwrap();
    ReducedModel::new(mesh, Modes::new(shape.rank, shape.displacements.clone()).unwrap()).unwrap()
}

/// Computes local certificates of every node, in scopes of every kind.
fn certify(model: &ReducedModel, seed: u64, random: &mut Numbers) -> Certificates {
    let scales = Metric::displacement(model.mesh(), model.modes()).unwrap().scales();
    let rank = model.rank();
    let metric = (seed.is_multiple_of(2) && rank < 40).then(|| {
        let entry = |i: usize, j: usize| scales[i] * scales[j] * if i == j { 1.0 } else { 0.2 / rank as f64 };
        let matrix: Vec<f64> = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
        Metric::from_matrix(MetricKind::Given, rank, &matrix).unwrap()
    });
    let center = seed.is_multiple_of(3).then(|| {
        let size = random.power(-4.0, -1.0) / (rank as f64).sqrt();
        scales.iter().map(|scale| size * random.signed() / scale).collect()
    });
    let neighbours = [Neighbours::Exclude, Neighbours::IncludeOneVertex][seed as usize / 2 % 2];
    let options = CertifyOptions::default()
        .metric(metric)
        .center(center)
        .filter(ContactFilter::new(neighbours).weld(seed % 5 < 3))
        .ignore_rest((seed % 4 == 3).then_some(0))
        .budget(0)
        .local_budget(1 << 20)
        .epsilon(0.9)
        .threads(1);
    Certificates::compute(model, &options, &()).unwrap()
}

/// Claims and exact tests on one model.
struct Attack<'a> {
    model: &'a ReducedModel,
    certificates: &'a Certificates,
    certified: Query,
    oracle: Query,
    index_in_order: Vec<u32>,
}

impl<'a> Attack<'a> {
    fn new(model: &'a ReducedModel, certificates: &'a Certificates) -> Self {
        let order = certificates.hierarchy().order();
        let mut index_in_order = vec![0; order.len()];
        order.iter().enumerate().for_each(|(i, t)| index_in_order[*t as usize] = i as u32);
        Self {
            model,
            certificates,
            certified: Query::new(model, certificates).unwrap(),
            oracle: Query::with_method(model, certificates, Method::Traditional).unwrap(),
            index_in_order,
        }
    }

    /// Whether a pair is one of two nodes.
    fn is_of(&self, nodes: NodePair, pair: Pair) -> bool {
        let all = self.certificates.hierarchy().nodes();
        let has = |n: u32, triangle: u32| {
            let Node { first_triangle, triangle_count, .. } = all[n as usize];
            (first_triangle..first_triangle + triangle_count)
                .contains(&self.index_in_order[triangle as usize])
        };
        let (n, m) = nodes;
        has(n, pair.0) && has(m, pair.1) || has(n, pair.1) && has(m, pair.0)
    }

    /// Draws a certificate, and the pair of its node with itself or with a node of its list.
    fn draw_claim(&self, random: &mut Numbers) -> (usize, NodePair) {
        let local = &self.certificates.parts().local;
        let index = random.below(local.nodes.len());
        let n = local.nodes[index];
        let list =
            &local.list_nodes[local.list_starts[index] as usize..local.list_starts[index + 1] as usize];
        let is_within = list.is_empty() || random.below(3) == 0;
        (index, (n, if is_within { n } else { list[random.below(list.len())] }))
    }

    /// Returns the claims at q; an empty list if q is out of range.
    fn claims(&mut self, index: usize, q: &[f64]) -> Vec<NodePair> {
        self.certified.local_claims(index, [q]).unwrap_or_default()
    }

    /// Returns the pairs that collide at q, without exceptions.
    fn collisions(&mut self, q: &[f64]) -> Vec<Pair> {
        let exceptions = self.certificates.exceptions();
        let mut pairs = self.oracle.discrete(q).unwrap().to_vec();
        pairs.retain(|pair| exceptions.binary_search(pair).is_err());
        pairs
    }

    fn at(&self, ray: &[f64], scale: f64) -> Vec<f64> {
        self.certificates.center().iter().zip(ray).map(|(c, d)| c + scale * d).collect()
    }

    /// Draws a direction: of few or many modes, or a part of a rotation.
    fn ray(&self, shape: &FlexibleShape, random: &mut Numbers) -> Vec<f64> {
        let scales = Metric::displacement(self.model.mesh(), self.model.modes()).unwrap().scales();
        let decay = random.below(3) as i32;
        let few = random.below(3) == 0;
        let mut ray: Vec<f64> = scales
            .iter()
            .enumerate()
            .map(|(k, scale)| {
                let weight = if few && random.below(4) > 0 { 0.0 } else { (1.0 + k as f64).powi(-decay) };
                random.signed() * weight / scale
            })
            .collect();
        let angle = 3.0 * random.signed();
        if random.below(2) == 0
            && let Some(turned) = shape.turned(random.vector() + DVec3::X * 0.01, angle)
        {
            let share = random.power(-3.0, 0.0);
            ray.iter_mut().zip(turned).for_each(|(x, y)| *x = *x * share + y);
        }
        ray
    }

    /// Returns the shortest offset at which points of two triangles of a claim meet, in the displacement metric.
    fn approach(&self, (n, m): NodePair, random: &mut Numbers) -> Option<Vec<f64>> {
        let Self { model, certificates, .. } = self;
        let scales = Metric::displacement(model.mesh(), model.modes()).unwrap().scales();
        let hierarchy = certificates.hierarchy();
        let (mut d, mut b) = (DVec3::ZERO, vec![DVec3::ZERO; model.rank()]);
        for (n, sign) in [(n, -1.0), (m, 1.0)] {
            let triangles = hierarchy.triangles(&hierarchy.nodes()[n as usize]);
            let face = model.mesh().faces()[triangles[random.below(triangles.len())] as usize];
            let weights = random.vector().abs() + DVec3::splat(1e-3);
            for (v, w) in face.into_iter().zip((weights / weights.element_sum()).to_array()) {
                d += model.position(v, certificates.center()) * w * sign;
                let modes = model.modes().of_vertex(v).iter().zip(&scales);
                b.iter_mut().zip(modes).for_each(|(b, (u, scale))| *b += *u * (w * sign / scale));
            }
        }
        let mut gram = DMat3::ZERO;
        b.iter().for_each(|b| gram += DMat3::from_cols(*b * b.x, *b * b.y, *b * b.z));
        let trace = gram.x_axis.x + gram.y_axis.y + gram.z_axis.z;
        let y = (gram + DMat3::from_diagonal(DVec3::splat(1e-10 * trace))).inverse() * d;
        let ray: Vec<f64> = b.iter().zip(&scales).map(|(b, scale)| -b.dot(y) / scale).collect();
        ray.iter().all(|x| x.is_finite()).then_some(ray)
    }

    /// Returns the largest scale found at which a claim holds, and one just beyond; `None` if the claim does not hold close to
    /// the centre.
    fn edge(&mut self, index: usize, claim: NodePair, ray: &[f64]) -> Option<[f64; 2]> {
        let mut holds = |scale: f64| self.claims(index, &self.at(ray, scale)).contains(&claim);
        let mut low = [1.0, 0.1, 1e-2, 1e-3, 1e-5].into_iter().find(|scale| holds(*scale))?;
        let mut high = low * 2.0;
        while holds(high) {
            (low, high) = (high, 2.0 * high);
            if high > 1e12 {
                break;
            }
        }
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if holds(middle) { low = middle } else { high = middle }
        }
        Some([low, high])
    }
}

/// Counts of the cases that an attack contained.
#[derive(Debug, Default)]
struct Seen {
    certificates: usize,
    claims: usize,
    pairs_of_nodes: usize,
    swept: usize,
    with_collisions: usize,
    largest_share: f64,
}

fn attack(shape: &FlexibleShape, seed: u64, rays: usize, seen: &mut Seen) {
    let random = &mut Numbers(seed + 4000);
    let model = model_of(shape);
    let certificates = certify(&model, seed, random);
    let mut attack = Attack::new(&model, &certificates);
    let local = &certificates.parts().local;
    seen.certificates += local.nodes.len();
    let mut last: Option<(usize, Vec<f64>)> = None;
    for _ in 0..rays {
        if local.nodes.is_empty() {
            break;
        }
        let (index, claim) = attack.draw_claim(random);
        let approach = (random.below(2) == 0).then(|| attack.approach(claim, random)).flatten();
        let ray = approach.unwrap_or_else(|| attack.ray(shape, random));
        let Some([edge, beyond]) = attack.edge(index, claim, &ray) else { continue };
        // The scales beyond, up to the first collision of the claim's pairs, measure how tight claims are.
        let mut collides = false;
        let within = [1.0, 0.999, 0.5 + 0.5 * random.signed().abs()].map(|share| share * edge);
        let outside = (0..16).map(|step| beyond * 1.12_f64.powi(step));
        for scale in within.into_iter().chain(outside) {
            if collides {
                break;
            }
            let q = attack.at(&ray, scale);
            if model.check_coordinates(&q).is_err() {
                continue;
            }
            let (claims, collisions) = (attack.claims(index, &q), attack.collisions(&q));
            for nodes in &claims {
                let hit = collisions.iter().find(|pair| attack.is_of(*nodes, **pair));
                assert_eq!(hit, None, "seed {seed}: claim {nodes:?} of {index} at scale {scale} of {ray:?}");
                seen.pairs_of_nodes += usize::from(nodes.0 != nodes.1);
            }
            seen.claims += claims.len();
            seen.with_collisions += usize::from(!claims.is_empty() && !collisions.is_empty());
            if !collides && scale > edge && collisions.iter().any(|pair| attack.is_of(claim, *pair)) {
                collides = true;
                seen.largest_share = seen.largest_share.max(edge / scale);
            }
        }
        // Motions between two edges.
        let q = attack.at(&ray, edge);
        if let Some((other, start)) = last.replace((index, q.clone()))
            && let Ok(claims) = attack.certified.local_claims(other, [&start, &q])
        {
            seen.swept += claims.len();
            for step in 0..if claims.is_empty() { 0 } else { 12 } {
                let t = f64::from(step) / 11.0;
                let between: Vec<f64> = start.iter().zip(&q).map(|(x, y)| x + t * (y - x)).collect();
                let collisions = attack.collisions(&between);
                for nodes in &claims {
                    let hit = collisions.iter().find(|pair| attack.is_of(*nodes, **pair));
                    assert_eq!(hit, None, "seed {seed}: swept claim {nodes:?} at {t}");
                }
            }
        }
    }
}

#[test]
fn claims_hold_up_to_where_they_end() {
    let mut seen = Seen::default();
    for seed in 0..cases(56) {
        let shape = Shape::ALL[seed as usize % Shape::ALL.len()];
        let rank = [1, 2, 5, 12, 28][seed as usize / 7 % 5];
        attack(&FlexibleShape::new(seed, shape, rank), seed, 50, &mut seen);
    }
    assert!(seen.claims > threshold(20_000) && seen.pairs_of_nodes > threshold(10_000), "{seen:?}");
    assert!(seen.swept > threshold(800) && seen.with_collisions > threshold(200), "{seen:?}");
    assert!(seen.largest_share > 0.6, "{seen:?}");
}

#[test]
fn claims_hold_for_many_modes_and_at_every_size() {
    let mut seen = Seen::default();
    attack(&FlexibleShape::new(3, Shape::Sheet, 188), 3, 20, &mut seen);
    for (seed, size) in [1e-150, 1e-40, 1e-9, 1e9, 1e50].into_iter().enumerate() {
        // Odd numbers have diagonal metrics.
        let (shape, seed) = (Shape::ALL[seed], 2 * seed as u64 + 1);
        attack(&FlexibleShape::new(seed, shape, 4).scaled(size), seed, 60, &mut seen);
    }
    assert!(seen.claims > 1000 && seen.pairs_of_nodes > 300, "{seen:?}");
}

/// Counts of the cases that an attack on regions contained.
#[derive(Debug, Default)]
struct SeenInRegions {
    claims: usize,
    checks: usize,
    capsules: usize,
    /// Configurations beyond a region at which the claim's pairs collide.
    beyond: usize,
}

/// Compares claims in the largest possible capsules and balls of kinetic queries with exact tests within them.
fn attack_regions(shape: &FlexibleShape, seed: u64, rays: usize, seen: &mut SeenInRegions) {
    let random = &mut Numbers(seed + 9000);
    let model = model_of(shape);
    let certificates = certify(&model, seed, random);
    let (metric, center) = (&certificates.parts().scope.metric, certificates.center());
    let scales = metric.scales();
    let kinetic = KineticQuery::new(&model, &certificates).unwrap();
    let rates = {
        let scaled = ScaledModel::new(&model, metric, center);
        CapsuleRates::new(&scaled, certificates.hierarchy(), &kinetic.query.context.detect.layout)
    };
    let mut attack = Attack::new(&model, &certificates);
    let local = &certificates.parts().local;
    let length = |d: &[f64]| d.iter().zip(&scales).map(|(d, s)| (d * s).powi(2)).sum::<f64>().sqrt();
    for _ in 0..if local.nodes.is_empty() { 0 } else { rays } {
        let (index, claim) = attack.draw_claim(random);
        let approach = (random.below(3) > 0).then(|| attack.approach(claim, random)).flatten();
        let ray = approach.unwrap_or_else(|| attack.ray(shape, random));
        let Some([edge, _]) = attack.edge(index, claim, &ray) else { continue };
        let of_ray = length(&ray);
        if !(of_ray * edge > 0.0 && of_ray * edge < 1e6) {
            continue;
        }
        let start = attack.at(&ray, edge * [0.0, 0.5, 0.9][random.below(3)]);
        // The region is a ball, or a capsule of any direction.
        let stretch = if random.below(2) == 0 { 0.0 } else { 0.1 * edge * random.signed() };
        let other = attack.ray(shape, random);
        let share = stretch * of_ray / length(&other).max(1e-300);
        let end: Vec<f64> = start.iter().zip(&other).map(|(x, d)| x + share * d).collect();
        let claims_within = |radius: f64| {
            // The reach of the region: twice that of its ends, as in kinetic queries.
            let reach = [&start, &end].map(|q| model.check_coordinates(q).unwrap_or(f64::INFINITY));
            let motion = CapsuleMotion::new(&rates, [&start, &end], radius, 2.0 * reach[0].max(reach[1]));
            kinetic.query.local_claims_during(index, &motion)
        };
        let holds = |radius: f64| claims_within(radius).contains(&claim);
        let whole = of_ray * edge;
        let Some(mut radius) = [1.0, 0.3, 0.1, 0.03, 0.01].map(|r| r * whole).into_iter().find(|r| holds(*r))
        else {
            continue;
        };
        let mut high = 4.0 * radius;
        for _ in 0..20 {
            let middle = 0.5 * (radius + high);
            if holds(middle) { radius = middle } else { high = middle }
        }
        let claims = claims_within(radius);
        seen.claims += claims.len();
        seen.capsules += usize::from(stretch != 0.0);
        let mut seen_beyond = false;
        for step in 0..28 {
            let is_within = step < 24;
            let distance = if is_within {
                radius * [1.0 - 1e-9, random.signed().abs()][usize::from(step % 4 == 3)]
            } else {
                radius * 3.0 * f64::from(1 << (step - 24))
            };
            // The points are along the claim's ray, towards a collision of its triangles, or anywhere.
            let approach = (is_within && step % 3 == 1).then(|| attack.approach(claim, random)).flatten();
            let direction = match approach {
                Some(approach) => approach,
                None if is_within && step % 3 == 2 => scales.iter().map(|s| random.signed() / s).collect(),
                None => ray.clone(),
            };
            let sign = if is_within && step % 8 == 0 { -1.0 } else { 1.0 };
            let share = sign * distance / length(&direction).max(1e-300);
            let t = [0.0, 1.0, random.signed().abs()][step % 3];
            let between = start.iter().zip(&end).map(|(x, y)| x * (1.0 - t) + y * t);
            let q: Vec<f64> = between.zip(&direction).map(|(x, d)| x + share * d).collect();
            if model.check_coordinates(&q).is_err() {
                continue;
            }
            let collisions = attack.collisions(&q);
            if !is_within {
                seen_beyond |= collisions.iter().any(|pair| attack.is_of(claim, *pair));
                continue;
            }
            for nodes in &claims {
                let hit = collisions.iter().find(|pair| attack.is_of(*nodes, **pair));
                assert_eq!(
                    hit, None,
                    "seed {seed}: {nodes:?} at {q:?} within {radius} of {start:?}, {end:?}"
                );
                seen.checks += 1;
            }
        }
        seen.beyond += usize::from(seen_beyond);
    }
}

#[test]
fn claims_in_regions_hold_in_all_of_them() {
    let mut seen = SeenInRegions::default();
    for seed in 0..cases(28) {
        // Odd numbers have diagonal metrics.
        let (seed, shape) = (2 * seed + 1, Shape::ALL[seed as usize % Shape::ALL.len()]);
        let rank = [1, 2, 5, 12, 28][seed as usize / 2 % 5];
        attack_regions(&FlexibleShape::new(seed, shape, rank), seed, 30, &mut seen);
    }
    assert!(seen.claims > threshold(1000) && seen.checks > threshold(20_000), "{seen:?}");
    assert!(seen.capsules > threshold(100) && seen.beyond > threshold(16), "{seen:?}");
}

/// Two triangles one above the other far from the origin have a gap of one unit in the last place, and modes move them by less:
/// rounding closes the gap, which stays open in exact arithmetic.
#[test]
fn rounding_of_positions_far_away_closes_gaps() {
    let far = 2.0_f64.powi(30);
    let unit = far * f64::EPSILON;
    let (mut closed, mut claimed) = (0, 0);
    for case in 0..80 {
        // Small shapes are so far away in their own units that the error is multiplied by a large number.
        let size = [1.0, 2.0_f64.powi(-10)][case / 40];
        let case = case % 40;
        let apart = f64::from(1 << (case / 2 % 10));
        let at =
            |i: u32, height: f64| DVec3::new(f64::from(i % 2) * size, f64::from(i / 2) * size, far + height);
        let p = [0.0, apart * unit].map(|height| [0, 1, 2].map(|i| at(i, height))).concat();
        // The position of the lower triangle is rounded up, that of the upper one is not.
        let lifts = [0.52, 0.48 + 0.01 * (case % 2) as f64];
        let entry = |row: usize, _| if row % 3 == 2 { lifts[row / 9] } else { 0.0 };
        let model = ReducedModel::new(
            TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap(),
            Modes::from_matrix(6, 1, entry).unwrap(),
        );
        let model = model.unwrap();
        let options = CertifyOptions::default().local_budget(1 << 20);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut attack = Attack::new(&model, &certificates);
        for index in 0..certificates.parts().local.nodes.len() {
            for scale in [1.0, 0.99, 0.97, 1.01, -1.0] {
                let q = [unit * scale];
                let (claims, collisions) = (attack.claims(index, &q), attack.collisions(&q));
                closed += usize::from(!collisions.is_empty());
                claimed += usize::from(!claims.is_empty());
                assert!(claims.is_empty() || collisions.is_empty(), "{case} {size} {scale}");
            }
        }
    }
    assert!(closed > 0, "{closed} {claimed}");
}

/// On the straight lines from a shape to its rotation by 180 degrees it is flat in between, though neither end is strained.
#[test]
fn half_a_turn_is_no_proof() {
    let mut tried = 0;
    for seed in (0..20).filter(|seed| FlexibleShape::new(*seed, Shape::Box, 2).is_affine) {
        let shape = FlexibleShape::new(seed, Shape::Box, 2);
        let model = model_of(&shape);
        let options = CertifyOptions::default().budget(0).local_budget(1 << 20);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut attack = Attack::new(&model, &certificates);
        let ends = [0.3, 0.3 + std::f64::consts::PI].map(|angle| shape.turned(DVec3::ONE, angle).unwrap());
        for index in 0..certificates.parts().local.nodes.len() {
            let of_ends = [&ends[0], &ends[1]].map(|q| attack.claims(index, q).len());
            tried += of_ends[0].min(of_ends[1]);
            let swept = attack.certified.local_claims(index, [&ends[0], &ends[1]]).unwrap();
            assert!(swept.is_empty(), "seed {seed}: {swept:?}");
        }
    }
    assert!(tried > 100, "{tried}");
}
