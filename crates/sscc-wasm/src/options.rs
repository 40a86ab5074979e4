//! Options of certificates and detectors: objects of JavaScript.

use serde::Deserialize;
use sscc::{CertifyOptions, ContactFilter, Neighbours, TriMesh};
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** Which pairs of triangles count. */
export interface FilterOptions {
    /** Whether pairs with common vertices count; "exclude" by default. "include-folded" is for detectors only. */
    neighbours?: "exclude" | "include-one-vertex" | "include-folded";
    /** Whether vertices of equal positions (and modes) are one, for adjacency alone; by default true for models of glTF files only. */
    weld?: boolean;
}

/** How certificates are computed. */
export interface CertifyOptions extends FilterOptions {
    /** "full" by default. With "paper", certificates take less time and memory, and queries beyond the root's radius take more time. */
    scheme?: "full" | "paper";
    /** Relative tolerance of the root's radius, in (0, 1); 0.1 by default. */
    epsilon?: number;
    /** The largest radius, in units of the paper's global radius: finite, at least 1; 1 by default. No effect with "paper". */
    reach?: number;
    /** The q from which radii are measured; 0 by default. */
    center?: number[] | Float64Array;
    /** Pairs that collide at rest never count, and neither do those within this number of rings of them. */
    ignoreRest?: number;
}
"#;

/// The given options.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "camelCase")]
pub struct Options {
    neighbours: Option<String>,
    weld: Option<bool>,
    scheme: Option<Scheme>,
    epsilon: Option<f64>,
    reach: Option<f64>,
    center: Option<Vec<f64>>,
    ignore_rest: Option<u32>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Scheme {
    Full,
    Paper,
}

#[wasm_bindgen]
extern "C" {
    /// Returns `None` for a value without JSON. Returns an error for an object that contains itself or a `BigInt`, and
    /// if the replacement of a value fails.
    #[wasm_bindgen(js_namespace = JSON, catch)]
    fn stringify(
        value: &JsValue,
        replacement: &Closure<dyn FnMut(String, JsValue) -> Result<JsValue, JsValue>>,
    ) -> Result<Option<String>, JsValue>;

    /// Whether a value is a typed array (or a `DataView`).
    #[wasm_bindgen(js_namespace = ArrayBuffer, js_name = isView)]
    fn is_typed_array(value: &JsValue) -> bool;

    /// Returns the prototype of a value; null for an object without one. Returns an error for null and `undefined`.
    #[wasm_bindgen(js_namespace = Object, js_name = getPrototypeOf, catch)]
    fn prototype_of(value: &JsValue) -> Result<JsValue, JsValue>;

    /// Returns a plain array of the same items.
    #[wasm_bindgen(js_namespace = Array, js_name = from, catch)]
    fn plain_array(value: &JsValue) -> Result<JsValue, JsValue>;
}

/// The message for options that are not an object.
const NO_OBJECT: &str = "it is no plain object";

/// Returns an object as JSON; `None` for `undefined`.
pub fn json(options: &JsValue) -> Result<Option<String>, JsError> {
    if options.is_undefined() {
        return Ok(None);
    }
    let refused = |cause: &str| JsError::new(&OptionsError(cause.to_owned()).to_string());
    if !is_plain(options) {
        return Err(refused(NO_OBJECT));
    }
    match stringify(options, &Closure::new(replaced)) {
        Ok(Some(text)) => Ok(Some(text)),
        Ok(None) => Err(refused(NO_OBJECT)),
        Err(error) => Err(refused(error.as_string().as_deref().unwrap_or(NO_OBJECT))),
    }
}

/// Whether a value is an object without a class: with the prototype of all objects, which has none itself, or without a prototype.
/// JSON would omit the items of a `Map` or a `Set`, and all that an object inherits.
fn is_plain(value: &JsValue) -> bool {
    let is_root = |prototype: JsValue| {
        prototype.is_null() || prototype_of(&prototype).is_ok_and(|above| above.is_null())
    };
    prototype_of(value).is_ok_and(is_root)
}

/// Returns the replacement of a value in JSON: a plain array for a typed array, else the value.
///
/// # Errors
/// For options that are not an object, for numbers that are not finite, and for functions and symbols: JSON would
/// replace them by null or omit them. `undefined` is valid, and JSON omits it.
fn replaced(key: String, value: JsValue) -> Result<JsValue, JsValue> {
    let refused = |cause: String| Err(JsValue::from_str(&cause));
    if key.is_empty() && !value.is_object() {
        return refused(NO_OBJECT.to_owned());
    }
    if is_typed_array(&value) {
        return plain_array(&value);
    }
    match value.as_f64() {
        Some(number) if !number.is_finite() => {
            refused(format!("{} is {number}: it must be finite", name(&key)))
        }
        _ if value.is_function() || value.is_symbol() => {
            refused(format!("{} is no value of an option", name(&key)))
        }
        _ => Ok(value),
    }
}

/// Returns the name of a key in messages. Keys of arrays are numbers.
fn name(key: &str) -> String {
    match key.parse::<usize>() {
        Ok(at) => format!("item {at} of an array"),
        Err(_) => key.to_owned(),
    }
}

impl Options {
    /// Parses options from JSON; the defaults for `None`.
    ///
    /// # Errors
    /// When the JSON is not an object, a key is not known, or a value has another type.
    pub fn parse(json: Option<&str>) -> Result<Self, OptionsError> {
        json.map_or(Ok(Self::default()), |json| {
            if !json.starts_with('{') {
                return Err(OptionsError(NO_OBJECT.to_owned()));
            }
            serde_json::from_str(json).map_err(|error| {
                let text = error.to_string();
                let cause = text.split_once(" at line").map_or(text.as_str(), |(cause, _)| cause);
                OptionsError(cause.to_owned())
            })
        })
    }

    /// Returns the options for certificates of a model with this mesh.
    ///
    /// # Errors
    /// When the name of `neighbours` is not known.
    pub fn for_mesh(self, mesh: &TriMesh) -> Result<CertifyOptions, sscc::Error> {
        let mut options = CertifyOptions::default()
            .filter(self.filter(mesh)?)
            .center(self.center)
            .ignore_rest(self.ignore_rest);
        if let Some(Scheme::Paper) = self.scheme {
            options = options.budget(0).local_budget(0);
        }
        if let Some(epsilon) = self.epsilon {
            options = options.epsilon(epsilon);
        }
        if let Some(reach) = self.reach {
            options = options.reach(reach);
        }
        Ok(options)
    }

    /// Returns the contact filter.
    ///
    /// # Errors
    /// When another option is set, or the name of `neighbours` is not known.
    pub fn filter_alone(&self, mesh: &TriMesh) -> Result<ContactFilter, OptionsError> {
        let Self { neighbours: _, weld: _, scheme, epsilon, reach, center, ignore_rest } = self;
        if scheme.is_some()
            || epsilon.is_some()
            || reach.is_some()
            || center.is_some()
            || ignore_rest.is_some()
        {
            return Err(OptionsError("a detector has the options neighbours and weld alone".to_owned()));
        }
        self.filter(mesh).map_err(|error| OptionsError(error.to_string()))
    }

    fn filter(&self, mesh: &TriMesh) -> Result<ContactFilter, sscc::Error> {
        let filter = match &self.neighbours {
            Some(name) => ContactFilter::new(name.parse::<Neighbours>()?).weld(mesh.has_split_vertices()),
            None => ContactFilter::of(mesh),
        };
        Ok(match self.weld {
            Some(weld) => filter.weld(weld),
            None => filter,
        })
    }
}

/// The error that options are invalid.
#[derive(Clone, Debug, PartialEq)]
pub struct OptionsError(String);

impl std::fmt::Display for OptionsError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "options: {}", self.0)
    }
}

impl std::error::Error for OptionsError {}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn invalid_options_are_refused_with_one_line() {
        let mesh = TriMesh::new(vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![[0, 1, 2]]).unwrap();
        let refused = |json: &str| {
            Options::parse(Some(json)).and_then(|options| options.filter_alone(&mesh).map(|_| ()))
        };
        assert!(refused("{\"neighbours\":\"include-one-vertex\",\"weld\":true}").is_ok());
        assert!(refused("{}").is_ok());
        for json in
            ["{\"neighbour\":1}", "{\"neighbours\":\"all\"}", "{\"weld\":1}", "[]", "3", "{\"epsilon\":0.1}"]
        {
            let error = refused(json).unwrap_err().to_string();
            assert!(
                error.starts_with("options: ") && !error.contains('\n') && !error.contains("line"),
                "{error}"
            );
        }
    }
}
