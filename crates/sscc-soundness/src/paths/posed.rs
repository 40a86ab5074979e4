//! Queries of two posed shapes in the world, discrete and continuous, and of two meshes by the detector. One shape meets partners
//! of two sizes by turns, so that what an earlier search has left is of another one.

use sscc::glam::{DMat3, DVec3};
use sscc::parts::{Pose, PosedShape, SweptShape};
use sscc::{Detector, Impact};

use super::moving_pairs::{Effort, Ends, attack_impact};
use super::share::some;
use crate::exact::work;
use crate::exact::{Point, Triangle};
use crate::models::Extremes;
use crate::oracle::pairs_between;
use crate::random::Random;
use crate::setup::{Setup, Wanted, mesh_of};
use crate::tally::Tally;

/// A pose in the world, in plain numbers.
#[derive(Clone, Debug)]
struct Place {
    columns: [Point; 3],
    translation: Point,
}

impl Place {
    fn random(random: &mut Random, reach: f64) -> Self {
        let axis = DVec3::from_array(random.point()).normalize_or(DVec3::X);
        let turn = if random.one_in(4) {
            DMat3::IDENTITY
        } else {
            DMat3::from_axis_angle(axis, 3.0 * random.signed())
        };
        let size = reach * random.power(-4.0, 0.0);
        let step = random.one_in(3);
        let translation =
            random.point().map(|x| if step { (4.0 * x).round() * 0.25 * size } else { x * size });
        Self { columns: [turn.x_axis, turn.y_axis, turn.z_axis].map(|c| c.to_array()), translation }
    }

    fn pose(&self) -> Pose {
        let [x_axis, y_axis, z_axis] = self.columns.map(DVec3::from_array);
        Pose { rotation: DMat3 { x_axis, y_axis, z_axis }, translation: DVec3::from_array(self.translation) }
    }

    /// Applies the pose to a point. Products and sums are in the order of the core.
    fn apply(&self, p: Point) -> Point {
        let [x, y, z] = self.columns;
        std::array::from_fn(|c| {
            let sum = x[c] * p[0] + y[c] * p[1];
            let sum = sum + z[c] * p[2];
            sum + self.translation[c]
        })
    }
}

fn triangles(setup: &Setup, q: &[f64], place: &Place) -> Vec<Triangle> {
    let points: Vec<Point> = setup.model.positions(q).into_iter().map(|p| place.apply(p)).collect();
    setup.model.faces.iter().map(|face| face.map(|v| points[v as usize])).collect()
}

/// Runs a shape and two partners at some poses.
pub fn run(random: &mut Random, tally: &mut Tally, share: f64) {
    let wanted = Wanted { triangles: 130, extremes: Extremes::Shape, has_center: false, is_dense: false };
    let smaller = Wanted { triangles: 12, ..wanted };
    let setups = [wanted, wanted, smaller].map(|wanted| Setup::random(random, &wanted));
    let [Ok(x), Ok(y), Ok(z)] = setups else {
        tally.reach("refused models");
        return;
    };
    let shapes = [&x, &y, &z].map(|setup| PosedShape::new(&setup.reduced, &setup.certificates).ok());
    let [Some(mut a), Some(b), Some(c)] = shapes else {
        let names = [&x, &y, &z].map(|setup| &setup.model.name);
        tally.wrong(|| format!("{names:?}: one of these refuses its own certificates"));
        return;
    };
    let mut partners = [(&y, b), (&z, c)];
    for _ in 0..some(100, share) {
        if work::is_spent() {
            break;
        }
        let (y, b) = &mut partners[usize::from(random.one_in(3))];
        let q = [x.draw(random), y.draw(random)];
        let places = [Place::random(random, x.size), Place::random(random, x.size)];
        let (box_a, box_b) = match (a.place(&q[0], &places[0].pose()), b.place(&q[1], &places[1].pose())) {
            (Ok(box_a), Ok(box_b)) => (box_a, box_b),
            (Err(error), _) => {
                x.refused(tally, &[&q[0]], &error);
                continue;
            }
            (_, Err(error)) => {
                y.refused(tally, &[&q[1]], &error);
                continue;
            }
        };
        let around = if random.one_in(2) { box_a.union(&box_b) } else { box_a };
        let mut found = Vec::new();
        if let Err(error) = a.colliding(b, around, &mut found) {
            tally.wrong(|| format!("{}: {error}", x.model.name));
            continue;
        }
        let exact = pairs_between(&triangles(&x, &q[0], &places[0]), &triangles(y, &q[1], &places[1]));
        tally.compare(&found, &exact, || {
            format!("{} and {}: q={q:?} at {places:?}", x.model.name, y.model.name)
        });
        if random.one_in(4) {
            swept(random, tally, [&x, y], [&a, b], &q, &places, &exact);
        }
    }
    two_meshes(random, tally, &x, [&y, &z], some(40, share));
}

/// Moves one shape to another pose. Pairs that collide at either end must be listed.
fn swept(
    random: &mut Random,
    tally: &mut Tally,
    [x, y]: [&Setup; 2],
    [a, b]: [&PosedShape; 2],
    q: &[Vec<f64>; 2],
    places: &[Place; 2],
    exact: &[(u32, u32)],
) {
    let (Ok(mut moving), Ok(mut resting)) = (SweptShape::new(a), SweptShape::new(b)) else { return };
    let (q_t1, to) = (x.draw(random), Place::random(random, x.size));
    let ends = (
        moving.place([&q[0], &q_t1], [&places[0].pose(), &to.pose()]),
        resting.place([&q[1], &q[1]], [&places[1].pose(), &places[1].pose()]),
    );
    let (Ok(box_a), Ok(box_b)) = ends else { return };
    let mut impacts: Vec<Impact> = Vec::new();
    if let Err(error) = moving.impacts(&mut resting, box_a.union(&box_b), &mut impacts) {
        tally.wrong(|| format!("{}: {error}", x.model.name));
        return;
    }
    tally.answer();
    tally.reach("swept");
    let from = triangles(x, &q[0], &places[0]);
    let till = triangles(x, &q_t1, &to);
    let still = triangles(y, &q[1], &places[1]);
    let there = pairs_between(&till, &still);
    let is_listed = |pair: &&(u32, u32)| impacts.iter().any(|impact| impact.pair == **pair);
    if let Some(pair) = exact.iter().chain(&there).find(|pair| !is_listed(pair)) {
        tally.false_negative(|| {
            format!(
                "{} and {}: swept: {pair:?} collides at an end; q={q:?} {q_t1:?} {places:?} {to:?}",
                x.model.name, y.model.name
            )
        });
    }
    for _ in 0..impacts.len().min(4) {
        let Impact { pair, time } = impacts[random.below(impacts.len())];
        let ends: [Ends; 2] = [
            [from[pair.0 as usize], till[pair.0 as usize]],
            [still[pair.1 as usize], still[pair.1 as usize]],
        ];
        let effort = if random.one_in(50) { Effort::Roots } else { Effort::Halving };
        attack_impact(random, tally, &ends[0], &ends[1], time, effort);
    }
}

/// Runs the same meshes with the detector.
fn two_meshes(random: &mut Random, tally: &mut Tally, x: &Setup, partners: [&Setup; 2], count: usize) {
    let Ok(mesh_x) = mesh_of(&x.model) else { return };
    let [Ok(mesh_y), Ok(mesh_z)] = partners.map(|setup| mesh_of(&setup.model)) else { return };
    let (mut a, mut others) = (Detector::new(&mesh_x), [&mesh_y, &mesh_z].map(Detector::new));
    for _ in 0..count {
        if work::is_spent() {
            break;
        }
        let partner = usize::from(random.one_in(3));
        let (y, b) = (partners[partner], &mut others[partner]);
        let q = [x.draw(random), y.draw(random)];
        let points = [x.model.positions(&q[0]), y.model.positions(&q[1])];
        let [p, r] =
            [&points[0], &points[1]].map(|p| p.iter().map(|p| DVec3::from_array(*p)).collect::<Vec<_>>());
        let found = match a.against(&p, b, &r) {
            Ok(found) => found,
            Err(error) => {
                tally.reach("refused frames");
                if !x.is_beyond_range(&q[0]) && !y.is_beyond_range(&q[1]) {
                    tally.wrong(|| format!("{} against {}: {error}", x.model.name, y.model.name));
                }
                continue;
            }
        };
        let of = |setup: &Setup, points: &[Point]| -> Vec<Triangle> {
            setup.model.faces.iter().map(|face| face.map(|v| points[v as usize])).collect()
        };
        let exact = pairs_between(&of(x, &points[0]), &of(y, &points[1]));
        tally.reach("two meshes");
        tally.compare(found, &exact, || format!("{} against {}: q={q:?}", x.model.name, y.model.name));
    }
}
