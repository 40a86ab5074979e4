//! The mesh of a detector, and a detector of the core for each thread that uses it concurrently.

use std::sync::{Arc, Mutex};

use glam::DVec3;
use pyo3::prelude::*;
use sscc::parts::detector_with_weld_classes;
use sscc::{ContactFilter, Detector, Error, TriMesh};

use crate::errors::{refused, value};
use crate::interrupt::signals;
use crate::pool::lock;
use crate::positions::Weld;

/// The mesh and its filter.
pub struct DetectorMesh {
    pub faces: Vec<[u32; 3]>,
    pub weld: Weld,
    pub filter: ContactFilter,
}

/// A built hierarchy.
pub struct Built {
    /// The positions from which it was built.
    pub rest: Vec<DVec3>,
    /// The detector from which the others are cloned.
    pub first: Detector,
}

pub struct DetectorPool {
    pub mesh: DetectorMesh,
    /// None until the first positions are known.
    built: Mutex<Option<Arc<Built>>>,
    /// Detectors that are not in use.
    idle: Mutex<Vec<Detector>>,
}

impl DetectorPool {
    pub fn of(mesh: DetectorMesh) -> Self {
        Self { mesh, built: Mutex::default(), idle: Mutex::default() }
    }

    /// Returns the hierarchy; `None` if it is not built. Waits without the GIL while another thread builds it.
    pub fn known(&self, py: Python<'_>) -> Option<Arc<Built>> {
        py.detach(|| lock(&self.built).clone())
    }

    /// Returns the hierarchy. Builds it from these positions if it is not built; `name` is the name of their argument. Call
    /// it without the GIL, because other threads wait for the end.
    pub fn built(&self, positions: &[DVec3], name: &str) -> PyResult<Arc<Built>> {
        let mut built = lock(&self.built);
        if let Some(built) = &*built {
            return Ok(Arc::clone(built));
        }
        let rest = positions.to_vec();
        let mesh = TriMesh::new(rest.clone(), self.mesh.faces.clone());
        let first = detector(&mesh.map_err(|error| refused(&error, name))?, &self.mesh, name)?;
        Ok(Arc::clone(built.insert(Arc::new(Built { rest, first: first.cancelled_by(signals().clone()) }))))
    }

    /// Runs a function on a detector that no other thread uses.
    pub fn with_detector<T>(&self, built: &Built, with: impl FnOnce(&mut Detector) -> T) -> T {
        let idle = lock(&self.idle).pop();
        let mut detector = idle.unwrap_or_else(|| built.first.clone());
        let answer = with(&mut detector);
        lock(&self.idle).push(detector);
        answer
    }
}

/// Returns a detector of the core. `name` is the argument of the positions.
pub fn detector(mesh: &TriMesh, options: &DetectorMesh, name: &str) -> PyResult<Detector> {
    let vertices = mesh.rest_positions().len();
    match &options.weld {
        Weld::Off | Weld::ByPosition => {
            Detector::with_filter(mesh, &options.filter).map_err(|error: Error| refused(&error, "faces"))
        }
        Weld::Classes(classes) if classes.len() == vertices => {
            let detector = detector_with_weld_classes(mesh, classes, &options.filter);
            detector.map_err(|error: Error| refused(&error, "weld"))
        }
        Weld::Classes(classes) => {
            Err(value(format!("weld has {} entries, but {name} has {vertices} vertices", classes.len())))
        }
    }
}
