//! The buffers of a glTF file: inside the file, in separate files, or in base64.

use std::fs;
use std::path::Path;

use gltf::buffer::Source;

use crate::Result;

/// Every buffer of a document; `blob` is the one contained in a `.glb` file.
pub fn read(document: &gltf::Document, folder: &Path, mut blob: Option<Vec<u8>>) -> Result<Vec<Vec<u8>>> {
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            Source::Bin => blob.take().ok_or("a buffer is missing")?,
            Source::Uri(uri) => from_uri(uri, folder)?,
        };
        if bytes.len() < buffer.length() {
            return Err(format!("a buffer has only {} of {} bytes", bytes.len(), buffer.length()).into());
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

fn from_uri(uri: &str, folder: &Path) -> Result<Vec<u8>> {
    if let Some(data) = uri.strip_prefix("data:") {
        let (_, text) = data.split_once(";base64,").ok_or("a buffer's data are not in base64")?;
        return Ok(base64(text).ok_or("a buffer's base64 is broken")?);
    }
    if let Some((scheme, _)) = uri.split_once(':') {
        return Err(format!("a buffer is at a {scheme} address: only local files next to the scene are read").into());
    }
    let path = folder.join(percent_decoded(uri).ok_or("a buffer's address is broken")?);
    fs::read(&path).map_err(|e| format!("cannot read {}: {e}", path.display()).into())
}

/// Decodes percent-encoding: `%20` is a space.
fn percent_decoded(text: &str) -> Option<String> {
    let mut parts = text.split('%');
    let mut bytes = parts.next()?.as_bytes().to_vec();
    for part in parts {
        bytes.push(u8::from_str_radix(part.get(..2)?, 16).ok()?);
        bytes.extend(&part.as_bytes()[2..]);
    }
    String::from_utf8(bytes).ok()
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let (mut bytes, mut bits, mut count) = (Vec::new(), 0u32, 0);
    for letter in text.trim_end_matches('=').bytes() {
        let value = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    // Six bits left over mean one letter too many.
    (count < 6).then_some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_is_decoded() {
        for (text, bytes) in [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9vYmFy", "foobar"), ("Pj4/", ">>?")] {
            assert_eq!(base64(text).unwrap(), bytes.as_bytes(), "{text}");
        }
        assert_eq!(base64("Zm9v!A=="), None);
        assert_eq!(base64("Z"), None);
    }

    #[test]
    fn percent_signs_are_decoded() {
        assert_eq!(percent_decoded("a%20b%C3%A9").unwrap(), "a b\u{e9}");
        for broken in ["%", "%2", "%zz", "%ff", "%\u{e9}"] {
            assert_eq!(percent_decoded(broken), None, "{broken}");
        }
    }
}
