use super::*;
use crate::shapes;

fn volume(lattice: &Lattice) -> f64 {
    lattice.fill.iter().flatten().sum::<f64>() * lattice.spacing.powi(3) / 8.0
}

#[test]
fn shapes_have_their_volume() {
    for (name, mesh) in [("spring", shapes::spring()), ("hare", shapes::hare()), ("serpent", shapes::serpent())] {
        let start = std::time::Instant::now();
        let lattice = Lattice::around(&mesh, None).unwrap();
        let surface = Surface::new(&mesh).unwrap();
        println!("{name} {} cubes {} vertices {:?} volume {} {}", lattice.cubes.len(), lattice.vertices.len(), start.elapsed(), volume(&lattice), surface.volume);
        assert!((volume(&lattice) / surface.volume - 1.0).abs() < 0.01);
        for (p, place) in mesh.rest_positions().iter().zip(&lattice.places) {
            let (cube, shares) = place.unwrap();
            let at: DVec3 = lattice.cubes[cube as usize].iter().zip(shares).map(|(v, s)| lattice.vertices[*v as usize] * s).sum();
            assert!((at - *p).length() < 1e-9 * lattice.spacing.max(p.length()));
        }
    }
}
