//! Buffers of a glTF file: in the file itself, or in separate files.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD_PAD_INDIFFERENT as BASE64;

use super::json;
use crate::error::quoted;
use crate::{FormatError, read_whole};

/// Buffers, loaded on demand.
pub(super) struct Buffers<'a> {
    declared: &'a [json::Buffer],
    /// Binary chunk of a GLB.
    chunk: Option<&'a [u8]>,
    /// Folder of separate buffer files; None forbids them.
    folder: Option<&'a Path>,
    sources: BTreeMap<usize, Source>,
    files: BTreeMap<PathBuf, Vec<u8>>,
}

enum Source {
    Chunk,
    Embedded(Vec<u8>),
    File(PathBuf),
}

impl<'a> Buffers<'a> {
    pub fn new(declared: &'a [json::Buffer], chunk: Option<&'a [u8]>, folder: Option<&'a Path>) -> Self {
        Self { declared, chunk, folder, sources: BTreeMap::new(), files: BTreeMap::new() }
    }

    /// Loads a buffer if it is not loaded.
    pub fn load(&mut self, index: usize) -> Result<(), FormatError> {
        let refused = |cause: String| FormatError::part(format!("buffers[{index}]"), cause);
        if self.sources.contains_key(&index) {
            return Ok(());
        }
        let buffer = self.declared.get(index).ok_or_else(|| refused("there is no such buffer".into()))?;
        let source = match &buffer.uri {
            None if buffer.extensions.is_fallback() => {
                let cause = "its bytes exist only compressed by the extension meshopt_compression, which is not supported: \
                             save the file without it";
                return Err(refused(cause.into()));
            }
            None if index == 0 && self.chunk.is_some() => Source::Chunk,
            None => return Err(refused("it has no uri, and the file has no binary chunk for it".into())),
            Some(uri) if has_scheme(uri, "data:") => Source::Embedded(embedded(uri).map_err(refused)?),
            Some(uri) => {
                let path = beside(uri).map_err(refused)?;
                let Some(folder) = self.folder else {
                    return Err(refused(format!(
                        "the file {} is needed, but these data have no folder: read the glTF file by its path",
                        quoted(uri)
                    )));
                };
                if !self.files.contains_key(&path) {
                    let bytes =
                        read_whole(&folder.join(&path)).map_err(|error| refused(error.to_string()))?;
                    self.files.insert(path.clone(), bytes);
                }
                Source::File(path)
            }
        };
        let found = self.bytes_of(&source).len();
        if buffer.byte_length > found {
            let cause = format!("it declares {} bytes, but has {found}", buffer.byte_length);
            return Err(refused(cause));
        }
        // A buffer that is too short must fail again when it is needed again.
        self.sources.insert(index, source);
        Ok(())
    }

    /// Returns the bytes of a buffer; empty if it is not loaded.
    pub fn get(&self, index: usize) -> &[u8] {
        let length = self.declared.get(index).map_or(0, |buffer| buffer.byte_length);
        let source = self.sources.get(&index);
        source.and_then(|source| self.bytes_of(source).get(..length)).unwrap_or_default()
    }

    /// Returns the total size of the files that were read.
    pub fn external_size(&self) -> u64 {
        self.files.values().map(|file| file.len() as u64).sum()
    }

    /// Returns all bytes of a source, which may be more than its buffer declares.
    fn bytes_of<'s>(&'s self, source: &'s Source) -> &'s [u8] {
        match source {
            Source::Chunk => self.chunk.unwrap_or_default(),
            Source::Embedded(bytes) => bytes,
            Source::File(path) => self.files.get(path).map(Vec::as_slice).unwrap_or_default(),
        }
    }
}

fn has_scheme(uri: &str, scheme: &str) -> bool {
    uri.get(..scheme.len()).is_some_and(|start| start.eq_ignore_ascii_case(scheme))
}

/// Returns the bytes of a `data:` URI.
fn embedded(uri: &str) -> Result<Vec<u8>, String> {
    let Some((media_type, text)) = uri.split_once(',') else {
        return Err("the data URI has no comma".into());
    };
    if !media_type.ends_with(";base64") {
        return Err("the data URI is not in base64".into());
    }
    BASE64.decode(text).map_err(|error| format!("not base64: {error}"))
}

/// Returns the path of a URI, in or below the folder of the glTF file. Other paths are rejected: an untrusted file must
/// not select arbitrary files to read.
fn beside(uri: &str) -> Result<PathBuf, String> {
    let refused = |cause: &str| Err(format!("{} {cause}", quoted(uri)));
    let Some(name) = percent_decoded(uri) else {
        return refused("has a malformed % escape");
    };
    if name.contains("://") {
        return refused("is a URL: only files in the folder of the glTF file are read");
    }
    if name.starts_with('/') || name.contains([':', '\\']) || name.split('/').any(|part| part == "..") {
        return refused("leads out of the folder: only files in the folder of the glTF file are read");
    }
    let path: PathBuf = name.split('/').filter(|part| !matches!(*part, "" | ".")).collect();
    if path.as_os_str().is_empty() || name.contains('\0') { refused("is not a file name") } else { Ok(path) }
}

fn percent_decoded(uri: &str) -> Option<String> {
    let mut parts = uri.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        let digits = part.get(..2).filter(|d| d.bytes().all(|b| b.is_ascii_hexdigit()))?;
        bytes.push(u8::from_str_radix(digits, 16).ok()?);
        bytes.extend(part[2..].bytes());
    }
    String::from_utf8(bytes).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_in_the_folder_are_accepted() {
        for (uri, path) in [("a.bin", "a.bin"), ("./b/c%20d.bin", "b/c d.bin"), ("b//a%C3%A9", "b/a\u{e9}")] {
            assert_eq!(beside(uri).unwrap(), Path::new(path));
        }
        for uri in [
            "/etc/passwd",
            "../a.bin",
            "b/../../a.bin",
            "%2e%2E/a.bin",
            "%2Fetc",
            "http://x/a.bin",
            "file:a.bin",
            "file:///a.bin",
            "C:\\a.bin",
            "C:a.bin",
            "..\\a.bin",
            "a%5c..",
            "",
            ".",
            "./",
            "a%0",
            "a%zz",
            "a%",
            "%ff",
            "a%00b",
            "%+1",
            "//x/y",
        ] {
            assert!(beside(uri).is_err(), "{uri}");
        }
    }

    #[test]
    fn a_buffer_that_is_too_short_is_refused_each_time() {
        let declared: Vec<json::Buffer> =
            serde_json::from_str(r#"[{"uri":"data:;base64,AAEC/w","byteLength":5},{"byteLength":2}]"#)
                .unwrap();
        let mut buffers = Buffers::new(&declared, None, None);
        for _ in 0..2 {
            let message = buffers.load(0).unwrap_err().to_string();
            assert_eq!(message, "buffers[0]: it declares 5 bytes, but has 4");
            assert!(buffers.get(0).is_empty());
        }
    }

    #[test]
    fn data_uris_are_decoded_from_base64_alone() {
        assert_eq!(embedded("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(embedded("data:;base64,AAEC/w").unwrap(), [0, 1, 2, 255]);
        assert!(embedded("data:;base64,A").unwrap_err().starts_with("not base64"));
        assert!(embedded("data:;base64,A\n=").is_err());
        assert!(embedded("data:text/plain,AAAA").unwrap_err().contains("not in base64"));
        assert!(embedded("data:").unwrap_err().contains("has no comma"));
    }
}
