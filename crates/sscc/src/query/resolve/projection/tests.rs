use super::*;
use crate::test_models::Random;

/// Half-spaces `normal . x >= offset`.
type HalfSpaces = Vec<(Vec<f64>, f64)>;

/// Adds the most violated half-space until none is violated.
fn project(target: &[f64], half_spaces: &HalfSpaces) -> Result<Projection, Infeasible> {
    let mut projection = Projection::new(target.to_vec());
    for _ in 0..1000 {
        let violation = |(normal, offset): &(Vec<f64>, f64)| {
            (offset - dot(normal, projection.point())) / length(normal).max(f64::MIN_POSITIVE)
        };
        let worst = half_spaces.iter().max_by(|a, b| violation(a).total_cmp(&violation(b)));
        match worst {
            Some(worst) if violation(worst) > 1e-10 => projection.add(&worst.0, worst.1)?,
            _ => return Ok(projection),
        }
    }
    panic!("the projection does not end");
}

fn assert_near(found: &[f64], expected: &[f64]) {
    let distance = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(distance < 1e-9, "{found:?} {expected:?}");
}

fn point(target: &[f64], half_spaces: &[(&[f64], f64)]) -> Vec<f64> {
    let all = half_spaces.iter().map(|(normal, offset)| (normal.to_vec(), *offset)).collect();
    project(target, &all).unwrap().point().to_vec()
}

#[test]
fn projections_on_a_few_half_spaces() {
    // No half-space, one that is not violated, and one that is violated.
    assert_near(&point(&[3.0, 4.0], &[]), &[3.0, 4.0]);
    assert_near(&point(&[3.0, 4.0], &[(&[1.0, 0.0], 2.0)]), &[3.0, 4.0]);
    assert_near(&point(&[3.0, 4.0], &[(&[-2.0, 0.0], -2.0)]), &[1.0, 4.0]);
    // A corner, and an edge where only one of two is active.
    assert_near(&point(&[3.0, 4.0], &[(&[-1.0, 0.0], 0.0), (&[0.0, -1.0], 0.0)]), &[0.0, 0.0]);
    assert_near(&point(&[3.0, -4.0], &[(&[-1.0, 0.0], 0.0), (&[0.0, -1.0], 0.0)]), &[0.0, -4.0]);
    // The first one becomes inactive again: the nearest point in the second one is inside it.
    let mut projection = Projection::new(vec![2.0, 0.0]);
    projection.add(&[-1.0, 0.1], -1.0).unwrap();
    projection.add(&[-1.0, -1.0], 2.0).unwrap();
    assert_near(projection.point(), &[0.0, -2.0]);
    assert_eq!(projection.active(), 1);
}

#[test]
fn parallel_half_spaces() {
    // Of two half-spaces with the same normal the narrower one counts, in any order.
    let narrow: (&[f64], f64) = (&[-2.0, 0.0], 2.0);
    let wide: (&[f64], f64) = (&[-1.0, 0.0], 0.5);
    assert_near(&point(&[3.0, 4.0], &[narrow, wide]), &[-1.0, 4.0]);
    let mut projection = Projection::new(vec![3.0, 4.0]);
    projection.add(wide.0, wide.1).unwrap();
    projection.add(narrow.0, narrow.1).unwrap();
    assert_near(projection.point(), &[-1.0, 4.0]);
    assert_eq!(projection.active(), 1);
    // Slabs, also one without thickness.
    assert_near(&point(&[3.0, 4.0], &[(&[-1.0, 0.0], -1.0), (&[1.0, 0.0], 0.5)]), &[1.0, 4.0]);
    assert_near(&point(&[3.0, 4.0], &[(&[-1.0, 0.0], -1.0), (&[1.0, 0.0], 1.0)]), &[1.0, 4.0]);
    // Nearly parallel half-spaces.
    assert_near(&point(&[3.0, 4.0], &[(&[-1.0, 1e-9], 0.0), (&[-1.0, 0.0], 1e-3)]), &[-1e-3, 4.0]);
}

#[test]
fn degenerate_half_spaces() {
    let mut projection = Projection::new(vec![1.0, 2.0]);
    // A half-space that contains all points, and an empty one.
    assert_eq!(projection.add(&[0.0, 0.0], 0.0), Ok(()));
    assert_eq!(projection.add(&[0.0, 0.0], -1.0), Ok(()));
    assert_eq!(projection.add(&[0.0, 0.0], 1e-300), Err(Infeasible));
    // Extreme lengths of normals change nothing.
    assert_eq!(projection.add(&[-1e-290, 0.0], 0.0), Ok(()));
    assert_eq!(projection.add(&[0.0, -1e290], 0.0), Ok(()));
    assert_near(projection.point(), &[0.0, 0.0]);
    // More than r half-spaces whose borders contain one point.
    let all = (0..12).map(|i| {
        let angle = f64::from(i) * 0.1;
        (vec![-angle.cos(), -angle.sin()], 0.0)
    });
    assert_near(project(&[2.0, 1.0], &all.collect()).unwrap().point(), &[0.0, 0.0]);
    // NaN and infinite numbers are refused.
    assert_eq!(Projection::new(vec![1.0]).add(&[f64::NAN], 2.0), Err(Infeasible));
    assert_eq!(Projection::new(vec![1.0]).add(&[1.0], f64::INFINITY), Err(Infeasible));
    // Rank 1.
    assert_near(&point(&[5.0], &[(&[-1.0], -2.0), (&[-3.0], -3.0), (&[1.0], -7.0)]), &[1.0]);
}

#[test]
fn half_spaces_without_a_common_point() {
    let infeasible: [&[(&[f64], f64)]; 3] = [
        &[(&[-1.0, 0.0], 1.0), (&[1.0, 0.0], 1.0)],
        // Three half-spaces that would be those of an inverted triangle.
        &[(&[1.0, 0.0], 1.0), (&[0.0, 1.0], 1.0), (&[-1.0, -1.0], 1.0)],
        &[(&[1.0, 0.0], 1.0), (&[1.0, 0.0], 2.0), (&[-1.0, 0.0], -1.5)],
    ];
    for half_spaces in infeasible {
        let all = half_spaces.iter().map(|(normal, offset)| (normal.to_vec(), *offset)).collect();
        assert!(project(&[0.25, -0.5], &all).is_err(), "{half_spaces:?}");
    }
}

/// The half-spaces are random and contain the origin. The test checks the conditions of Karush, Kuhn and Tucker, which
/// only the nearest point fulfils.
#[test]
fn random_projections_are_nearest_points() {
    let random = &mut Random(3);
    let (mut corners, mut most) = (0, 0);
    for case in 0..400 {
        let rank = 1 + case % 9;
        let vector = |random: &mut Random| -> Vec<f64> { (0..rank).map(|_| random.signed()).collect() };
        let mut half_spaces: HalfSpaces = (0..case % 40)
            .map(|_| (vector(random), -random.signed().abs() * f64::from(u8::from(case % 3 > 0)) * 0.2))
            .collect();
        // Equal and dependent half-spaces.
        for i in 0..half_spaces.len() / 4 {
            let sum: Vec<f64> =
                half_spaces[i].0.iter().zip(&half_spaces[i + 1].0).map(|(a, b)| a + b).collect();
            let offset = half_spaces[i].1 + half_spaces[i + 1].1;
            half_spaces.push((sum, offset));
            half_spaces.push(half_spaces[i].clone());
        }
        let target: Vec<f64> = vector(random).iter().map(|x| 3.0 * x).collect();
        let projection = project(&target, &half_spaces).unwrap();
        let x = projection.point();
        for (normal, offset) in &half_spaces {
            assert!(dot(normal, x) >= offset - 1e-8, "case {case}");
        }
        // The displacement from the target is a sum of active normals with non-negative multipliers.
        let mut way: Vec<f64> = x.iter().zip(&target).map(|(x, t)| x - t).collect();
        for (at, column) in projection.columns.iter().enumerate() {
            let u = projection.multipliers[at];
            assert!(u >= 0.0, "case {case}");
            for (r, q) in column.iter().zip(&projection.basis) {
                way.iter_mut().zip(q).for_each(|(x, q)| *x -= u * r * q);
            }
        }
        assert!(length(&way) < 1e-8, "case {case}: {way:?}");
        corners += usize::from(projection.active() == rank);
        most = most.max(projection.active());
    }
    assert!(corners > 20 && most > 5, "{corners} {most}");
}
