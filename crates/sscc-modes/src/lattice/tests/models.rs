//! Lattices of real models.

use super::{lattice, mesh_volume, volume};

#[test]
fn bunny_and_dragon() {
    let Some(folder) = sscc_testing::models("bunny_and_dragon") else { return };
    for name in ["bunny_14964_closed.obj", "dragon_77202_closed.ply"] {
        let mesh = sscc_io::read_mesh(&folder.join(name)).expect("a mesh");
        for cells in [None, Some(20)] {
            let lattice = lattice(&mesh, cells);
            let error = volume(&lattice) / mesh_volume(&mesh) - 1.0;
            assert!(error.abs() < 0.003, "{name}, {cells:?}: {error}");
            assert!(cells.is_some() || (18_000..22_000).contains(&lattice.cubes.len()), "{name}");
        }
    }
}
