//! Structure of a glTF file's JSON, as far as meshes need it.
//!
//! Fields that the format requires are required here. This also bounds memory, because a list of empty entries would
//! take a hundred times its bytes.

use serde::de::IgnoredAny;
use serde::{Deserialize, Deserializer};

use crate::FormatError;
use crate::error::{cut, quoted};

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Root {
    #[serde(default, deserialize_with = "or_default")]
    pub extensions_required: Vec<String>,
    #[serde(default, deserialize_with = "or_default")]
    pub buffers: Vec<Buffer>,
    #[serde(default, deserialize_with = "or_default")]
    pub buffer_views: Vec<BufferView>,
    #[serde(default, deserialize_with = "or_default")]
    pub accessors: Vec<Accessor>,
    #[serde(default, deserialize_with = "or_default")]
    pub meshes: Vec<Mesh>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Buffer {
    pub uri: Option<String>,
    pub byte_length: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub extensions: BufferExtensions,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub buffer: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: usize,
    pub byte_length: usize,
    pub byte_stride: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: usize,
    pub component_type: u32,
    #[serde(default, deserialize_with = "or_default")]
    pub normalized: bool,
    pub count: usize,
    #[serde(rename = "type")]
    pub kind: Kind,
    pub sparse: Option<Sparse>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(super) enum Kind {
    #[serde(rename = "SCALAR")]
    Scalar,
    #[serde(rename = "VEC3")]
    Vec3,
    #[serde(rename = "VEC4")]
    Vec4,
    #[serde(rename = "MAT4")]
    Mat4,
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub count: usize,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: usize,
    pub component_type: u32,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparseValues {
    pub buffer_view: usize,
    #[serde(default, deserialize_with = "or_default")]
    pub byte_offset: usize,
}

#[derive(Deserialize)]
pub(super) struct Mesh {
    pub name: Option<String>,
    pub primitives: Vec<Primitive>,
    #[serde(default, deserialize_with = "or_default")]
    pub weights: Vec<f64>,
    #[serde(default, deserialize_with = "or_default")]
    pub extras: Option<Extras>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    pub attributes: Attributes,
    pub indices: Option<usize>,
    pub mode: Option<u32>,
    #[serde(default, deserialize_with = "or_default")]
    pub targets: Vec<Attributes>,
    #[serde(default, deserialize_with = "or_default")]
    pub extensions: Extensions,
}

/// Accessors of a primitive or of one of its morph targets.
#[derive(Deserialize)]
pub(super) struct Attributes {
    #[serde(rename = "POSITION")]
    pub position: Option<usize>,
}

/// Extras can have any content; exporters store the names of targets here.
#[derive(Deserialize)]
#[serde(untagged)]
pub(super) enum Extras {
    Names {
        #[serde(rename = "targetNames")]
        target_names: Vec<String>,
    },
    #[allow(dead_code, reason = "serde needs a field to skip a value of any kind")]
    Other(IgnoredAny),
}

/// The extension that compresses the geometry of a primitive. Where a file does not require it, the file has the same
/// data without compression, which the reader takes.
#[derive(Default, Deserialize)]
pub(super) struct Extensions {
    #[serde(rename = "KHR_draco_mesh_compression")]
    draco: Option<IgnoredAny>,
}

impl Extensions {
    /// Whether accessors of the primitive may lack their data, because they are compressed.
    pub fn is_compressed(&self) -> bool {
        self.draco.is_some()
    }
}

/// The mark of a buffer whose bytes a file may leave out, because all views of it are compressed.
#[derive(Default, Deserialize)]
pub(super) struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    meshopt: Option<Fallback>,
    #[serde(rename = "KHR_meshopt_compression")]
    khr_meshopt: Option<Fallback>,
}

#[derive(Deserialize)]
struct Fallback {
    #[serde(default, deserialize_with = "or_default")]
    fallback: bool,
}

impl BufferExtensions {
    /// Whether all views of the buffer are compressed.
    pub fn is_fallback(&self) -> bool {
        [&self.meshopt, &self.khr_meshopt].into_iter().flatten().any(|mark| mark.fallback)
    }
}

/// Takes `null` as a missing value: some exporters write it.
pub(super) fn or_default<'de, D: Deserializer<'de>, T: Deserialize<'de> + Default>(
    deserializer: D,
) -> Result<T, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or_default())
}

fn unsupported(extension: &str) -> String {
    format!("the extension {} is not supported: save the file without it", quoted(extension))
}

#[derive(Deserialize)]
struct Head {
    asset: Asset,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    version: String,
    min_version: Option<String>,
}

/// Prefixes of supported extensions. They do not change positions (colours, images, light, texts, faces of polygons,
/// rigs of avatars), or quantize numbers, which the reader decodes.
const SUPPORTED_EXTENSIONS: [&str; 14] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_node_",
    "KHR_mesh_quantization",
    "KHR_xmp",
    "KHR_audio",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "FB_ngon_encoding",
    "VRM",
];

/// Parses those parts of the JSON that a type has.
pub(super) fn parse_parts<'a, T: Deserialize<'a>>(text: &'a [u8]) -> Result<T, FormatError> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    serde_json::from_slice(text).map_err(|e| FormatError::part("JSON", cut(&e.to_string(), 160)))
}

impl Root {
    pub fn parse(text: &[u8]) -> Result<Self, FormatError> {
        // The version is checked first: other versions have another structure.
        let Head { asset } = parse_parts(text)?;
        let is_supported = asset.min_version.as_ref().is_none_or(|minimum| minimum == "2.0");
        if !(asset.version == "2" || asset.version.starts_with("2.")) || !is_supported {
            let version =
                quoted(asset.min_version.filter(|_| !is_supported).as_ref().unwrap_or(&asset.version));
            let cause =
                format!("version {version} of the format is not supported: save the file as glTF 2.0");
            return Err(FormatError::part("asset", cause));
        }
        let root: Self = parse_parts(text)?;
        match root
            .extensions_required
            .iter()
            .find(|name| !SUPPORTED_EXTENSIONS.iter().any(|h| name.starts_with(h)))
        {
            Some(name) => Err(FormatError::part("extensionsRequired", unsupported(name))),
            None => Ok(root),
        }
    }
}
