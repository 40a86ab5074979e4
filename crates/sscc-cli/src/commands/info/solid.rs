//! The contents of a solid file.

use glam::DVec3;
use serde::Serialize;
use sscc_solid::{NamedMaterial, PartialMaterial, VolumeMesh};
use sscc_tasks::SolidSource;

use super::surface::{Surface, size};
use crate::flags;
use crate::output::{counted, grouped, note, one_line};

/// Maximum number of materials in the text; the JSON has all.
const MAX_SHOWN: usize = 8;

#[derive(Serialize)]
pub struct Solid {
    vertices: usize,
    tetrahedra: usize,
    cubes: usize,
    materials: Vec<Material>,
    /// Triangles that the file lists beside the elements.
    listed_triangles: usize,
    lower: [f64; 3],
    upper: [f64; 3],
    /// The boundary surface of the elements; null if `sscc modes` refuses the solid.
    boundary: Option<Surface>,
    /// The reason of the refusal.
    #[serde(skip_serializing_if = "Option::is_none")]
    refusal: Option<String>,
}

/// A material, and the number of its elements. Numbers that the file does not state are null.
#[derive(Serialize)]
struct Material {
    name: String,
    elements: usize,
    youngs_modulus: Option<f64>,
    poisson_ratio: Option<f64>,
    density: Option<f64>,
    /// Kind of a material whose stiffness is not computed.
    #[serde(skip_serializing_if = "Option::is_none")]
    unsupported: Option<String>,
}

impl Solid {
    pub fn of(file: &VolumeMesh) -> Self {
        let mut elements = vec![0; file.materials().len()];
        file.element_material().iter().for_each(|material| elements[*material as usize] += 1);
        let material =
            |(NamedMaterial { name, stated, unsupported }, elements): (&NamedMaterial, usize)| Material {
                name: name.clone(),
                elements,
                youngs_modulus: stated.youngs_modulus,
                poisson_ratio: stated.poisson_ratio,
                density: stated.density,
                unsupported: unsupported.clone(),
            };
        let surface = SolidSource::whole(file, &PartialMaterial::default());
        let (boundary, refusal) = match surface {
            Ok(source) => {
                source.note().into_iter().for_each(note);
                (Some(Surface::of(source.mesh())), None)
            }
            Err(error) => (None, Some(flags::message(&error))),
        };
        let points = || file.vertices().iter().copied();
        Self {
            vertices: file.vertices().len(),
            tetrahedra: file.tets().len(),
            cubes: file.cubes().len(),
            materials: file.materials().iter().zip(elements).map(material).collect(),
            listed_triangles: file.surface().len(),
            lower: points().reduce(DVec3::min).unwrap_or_default().to_array(),
            upper: points().reduce(DVec3::max).unwrap_or_default().to_array(),
            boundary,
            refusal,
        }
    }

    pub fn lines(&self) -> Vec<String> {
        let [tetrahedra, cubes, vertices, listed] =
            [self.tetrahedra, self.cubes, self.vertices, self.listed_triangles].map(|n| grouped(n as u64));
        let mut lines =
            vec![format!("solid          {tetrahedra} tetrahedra, {cubes} cubes, {vertices} vertices")];
        lines.extend(self.materials.iter().take(MAX_SHOWN).map(Material::line));
        if self.materials.len() > MAX_SHOWN {
            lines.push(format!(
                "               ... and {} more; --json lists all",
                self.materials.len() - MAX_SHOWN
            ));
        }
        lines.push(format!("box            {}", size(&self.lower, &self.upper)));
        lines.push(match &self.boundary {
            Some(surface) => format!("surface        {}", surface.form()),
            None => {
                format!("surface        refused: {}", one_line(self.refusal.as_deref().unwrap_or_default()))
            }
        });
        lines.push(format!("listed faces   {listed} triangles"));
        lines
    }
}

impl Material {
    fn line(&self) -> String {
        let stated =
            [("youngs", self.youngs_modulus), ("poisson", self.poisson_ratio), ("density", self.density)];
        let stated: Vec<String> = stated
            .into_iter()
            .filter_map(|(name, value)| value.map(|value| format!("{name}={value}")))
            .collect();
        let stated = if stated.is_empty() { "no numbers stated".to_owned() } else { stated.join(",") };
        let stated = match &self.unsupported {
            Some(kind) => format!("{stated}; the stiffness of the kind {} is not computed", one_line(kind)),
            None => stated,
        };
        let name = one_line(&self.name);
        format!("material       {name}: {stated}; {}", counted(self.elements as u64, "element"))
    }
}
