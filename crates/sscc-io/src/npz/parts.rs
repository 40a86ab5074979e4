//! Converts arrays of an archive into parts of a model.

use std::collections::BTreeMap;

use glam::DVec3;
use sscc::{Modes, TriMesh};

use super::archive;
use super::deviations::deviations;
use super::names::Part;
use super::number_limit::check_numbers;
use crate::modes::array;
use crate::npy::{self, Array};
use crate::{FormatError, Message, Place, Setting};

/// Recognised arrays of an archive: name and bytes.
pub(super) struct Parts(BTreeMap<Part, (String, Vec<u8>)>);

impl Parts {
    /// Reads these parts. Several arrays for one part are an error. Several arrays for an optional part are skipped, because
    /// none of them can be preferred.
    pub fn read(bytes: &[u8], wanted: &[Part], optional: Option<Part>) -> Result<Self, FormatError> {
        let is_wanted =
            |name: &str| Part::of(name).is_some_and(|part| wanted.contains(&part) || optional == Some(part));
        let mut is_ambiguous = false;
        let mut parts = BTreeMap::new();
        for (name, content) in archive::entries(bytes, is_wanted)? {
            let Some(part) = Part::of(&name) else { continue };
            if let Some((other, _)) = parts.insert(part, (name.clone(), content)) {
                if optional == Some(part) {
                    is_ambiguous = true;
                    continue;
                }
                let cause =
                    format!("'{other}' and '{name}' are the same part of the model: remove one of them");
                return Err(FormatError::whole(cause));
            }
        }
        if let Some(part) = optional.filter(|_| is_ambiguous) {
            parts.remove(&part);
        }
        if parts.contains_key(&Part::Modes) && parts.contains_key(&Part::Components) {
            let [a, b] = [Part::Modes, Part::Components].map(|part| parts[&part].0.clone());
            let cause = format!("'{a}' and '{b}' are the same part of the model: remove one of them");
            return Err(FormatError::whole(cause));
        }
        let counted = parts.values().filter_map(|(name, content)| {
            // A malformed array has its error when it is decoded.
            Some((name.as_str(), npy::entry_count(content)?))
        });
        check_numbers(bytes.len() as u64, counted)?;
        Ok(Self(parts))
    }

    fn get<T>(
        &self,
        part: Part,
        parse: impl Fn(&[u8]) -> Result<T, FormatError>,
    ) -> Result<Option<T>, FormatError> {
        let Some((name, bytes)) = self.0.get(&part) else { return Ok(None) };
        parse(bytes).map(Some).map_err(|error| FormatError::part(archive::place(name), error.to_string()))
    }

    fn missing(part: Part, advice: impl Into<Message>) -> FormatError {
        let cause = Message::from(format!("the archive has no array named {}", part.names()));
        FormatError::whole(cause + advice)
    }

    /// Returns the rest positions, one per vertex.
    pub fn mean(&self) -> Result<Option<Vec<DVec3>>, FormatError> {
        self.get(Part::Mean, |bytes| {
            let array = npy::parse(bytes)?;
            match *array.shape() {
                [_, 3] => {}
                [n] if n.is_multiple_of(3) => {}
                ref other => {
                    let cause = format!("shape {other:?}: (V, 3) or (3V) was expected");
                    return Err(FormatError::whole(cause));
                }
            }
            let values = array.into_c_order();
            Ok(values.as_chunks().0.iter().map(|xyz| DVec3::from_array(*xyz)).collect())
        })
    }

    /// Returns the modes for this number of vertices.
    pub fn modes(&self, vertices: usize) -> Result<Modes, FormatError> {
        let rows = |bytes: &[u8]| array::from_rows(&npy::parse(bytes)?, vertices);
        if let Some(modes) = self.get(Part::Components, rows)? {
            return Ok(modes);
        }
        let columns = |bytes: &[u8]| array::from_array(&npy::parse(bytes)?, vertices);
        self.get(Part::Modes, columns)?
            .ok_or_else(|| Self::missing(Part::Modes, format!(", {}", Part::Components.names())))
    }

    /// Returns the mesh of a complete model.
    pub fn mesh(&self) -> Result<TriMesh, FormatError> {
        let mean = self.mean()?.ok_or_else(|| Self::missing(Part::Mean, ""))?;
        let faces = self.get(Part::Faces, |bytes| faces(npy::parse_integers(bytes)?, mean.len()))?;
        let advice = || ": pass it as " + Setting::Modes + " of a mesh file";
        let faces = faces.ok_or_else(|| Self::missing(Part::Faces, advice()))?;
        Ok(TriMesh::new(mean, faces)?)
    }

    /// Returns one number for each of r modes. An array of this name that has not exactly one axis is ignored: body
    /// models store skinning weights there.
    pub fn weights(&self, rank: usize) -> Result<Option<Vec<f64>>, FormatError> {
        let weights = self.get(Part::Weights, |bytes| {
            let array = npy::parse(bytes)?;
            let [length] = *array.shape() else { return Ok(None) };
            if length != rank {
                return Err(FormatError::whole(format!("there are {length} numbers for {rank} modes")));
            }
            Ok(Some(array.into_c_order()))
        });
        Ok(weights?.flatten())
    }

    /// Returns the standard deviation of each entry of q, if an array has one variance for each of these modes.
    pub fn deviations(&self, modes: &Modes) -> Option<Vec<f64>> {
        let (name, _) = self.0.get(&Part::Weights)?;
        let is_variance = match name.as_str() {
            "explained_variance" | "explained_variance_" => true,
            // Eigenvalues beside other modes may be those of vibrations.
            "eigenvalues" => self.0.contains_key(&Part::Components),
            _ => false,
        };
        let variances = self.weights(modes.rank()).ok().flatten().filter(|_| is_variance)?;
        deviations(&variances, modes)
    }
}

fn faces(array: Array<i64>, vertices: usize) -> Result<Vec<[u32; 3]>, FormatError> {
    let [_, 3] = *array.shape() else {
        return Err(FormatError::whole(format!("shape {:?}: (N, 3) was expected", array.shape())));
    };
    let corner = |face: usize, index: i64| match u32::try_from(index) {
        Ok(corner) if (corner as usize) < vertices => Ok(corner),
        _ => {
            let cause =
                format!("face {face} names vertex {index} (counted from 0), but there are {vertices}");
            Err(FormatError::new(Place::Whole, cause))
        }
    };
    let indices = array.into_c_order();
    let triples = indices.as_chunks::<3>().0;
    let mut faces = Vec::with_capacity(triples.len());
    for (face, [a, b, c]) in triples.iter().enumerate() {
        faces.push([corner(face, *a)?, corner(face, *b)?, corner(face, *c)?]);
    }
    Ok(faces)
}
