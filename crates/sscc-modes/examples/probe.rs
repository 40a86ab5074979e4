use sscc_modes::*;
use std::path::Path;
use std::time::Instant;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mesh = match a[1].as_str() {
        "spring" => shapes::spring(),
        "hare" => shapes::hare(),
        "serpent" => shapes::serpent(),
        p => sscc_io::read_mesh(Path::new(p)).unwrap(),
    };
    let cells = a[2].parse::<usize>().ok();
    let rank: usize = a[3].parse().unwrap();
    let t = Instant::now();
    let e = Embedded::new(&mesh, cells, Material::default(), &()).unwrap();
    println!(
        "lattice {:?}: {} cubes {} dofs, spacing {}",
        t.elapsed(),
        e.solid().cubes().len(),
        3 * e.solid().vertices().len(),
        e.spacing()
    );
    let t = Instant::now();
    let m = if a[4] == "l" {
        linear_modes(e.solid(), &[], rank, &())
    } else {
        nonlinear_modes(e.solid(), &[], rank, &())
    }
    .unwrap();
    println!("modes {:?} {:?}", t.elapsed(), m.frequencies());
}
