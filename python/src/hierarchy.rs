//! `sscc.Hierarchy`: the BVH over the triangles, as arrays with one entry for each node.

use std::sync::Arc;

use pyo3::prelude::*;
use sscc::parts::Node;
use sscc_tasks::text::counted;

use crate::arrays::line;
use crate::pool::Pool;

#[pyclass(frozen, module = "sscc", name = "Hierarchy")]
pub struct Hierarchy {
    pool: Arc<Pool>,
}

impl Hierarchy {
    pub fn of(pool: Arc<Pool>) -> Self {
        Self { pool }
    }

    fn core(&self) -> &sscc::parts::Hierarchy {
        &self.pool.certified.certificates.parts().hierarchy
    }

    fn of_nodes<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        of: impl Fn(&Node) -> T,
    ) -> Bound<'py, PyAny> {
        line(py, self.core().nodes().iter().map(of).collect())
    }
}

#[pymethods]
impl Hierarchy {
    #[getter]
    fn parent<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let nodes = self.core().nodes();
        let mut parent = vec![-1_i32; nodes.len()];
        for (index, node) in nodes.iter().enumerate() {
            node.children().for_each(|child| parent[child as usize] = index as i32);
        }
        line(py, parent)
    }

    #[getter]
    fn level<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let mut level = Vec::with_capacity(self.core().nodes().len());
        for (number, range) in self.core().levels().into_iter().enumerate() {
            level.extend(range.map(|_| number as i32));
        }
        line(py, level)
    }

    #[getter]
    fn first<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.of_nodes(py, |node| node.first_triangle)
    }

    #[getter]
    fn count<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        self.of_nodes(py, |node| node.triangle_count)
    }

    #[getter]
    fn order<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        line(py, self.core().order().to_vec())
    }

    #[getter]
    fn radius<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        line(py, self.pool.certified.certificates.parts().node_radii.clone())
    }

    fn __len__(&self) -> usize {
        self.core().nodes().len()
    }

    fn __repr__(&self) -> String {
        format!(
            "<sscc.Hierarchy: {}, {}>",
            counted(self.core().nodes().len() as u64, "node"),
            counted(self.core().levels().len() as u64, "level")
        )
    }
}
