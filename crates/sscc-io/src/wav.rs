//! Writer for WAV sound files with one channel.

use std::io::Cursor;
use std::path::Path;

use hound::{SampleFormat, WavSpec, WavWriter};

use crate::{IoError, write_whole};

/// Number format of samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WavFormat {
    /// 16-bit integers: 1 is 32,767; louder samples are clipped.
    Pcm16,
    /// Single precision, without clipping.
    Float32,
}

/// Maximum number of bytes of samples: the format stores sizes in 32 bits, header included.
const MAX_BYTES: usize = u32::MAX as usize - 4096;

/// Writes a sound with one channel. `rate` is in samples per second; the nominal range of samples is -1 to 1.
///
/// # Errors
/// When the rate is 0, or so large that a second has 4 GiB of samples or more; when a sample is not finite in single
/// precision; when the samples take more than 4 GiB minus 4097 bytes; when the file cannot be written.
pub fn write_wav(path: &Path, rate: u32, samples: &[f64], format: WavFormat) -> Result<(), IoError> {
    let bytes = wav_to_bytes(rate, samples, format).map_err(|cause| IoError::request(path, cause))?;
    write_whole(path, &bytes)
}

/// Returns the bytes of the file that [`write_wav`] writes.
///
/// # Errors
/// As [`write_wav`]; the message has one line without a file name.
pub fn wav_to_bytes(rate: u32, samples: &[f64], format: WavFormat) -> Result<Vec<u8>, String> {
    let (bits_per_sample, sample_format) = match format {
        WavFormat::Pcm16 => (16, SampleFormat::Int),
        WavFormat::Float32 => (32, SampleFormat::Float),
    };
    let size = usize::from(bits_per_sample / 8);
    let max_rate = u32::MAX / size as u32;
    if rate == 0 || rate > max_rate {
        return Err(format!("the sound has {rate} samples per second: use 1 to {max_rate}"));
    }
    let max_samples = MAX_BYTES / size;
    if samples.len() > max_samples {
        return Err(format!(
            "the sound has {} samples: a file can have at most {max_samples}",
            samples.len()
        ));
    }
    if let Some(at) = samples.iter().position(|x| !(*x as f32).is_finite()) {
        return Err(format!("sample {at} is {:e}: it must be finite in single precision", samples[at]));
    }
    let spec = WavSpec { channels: 1, sample_rate: rate, bits_per_sample, sample_format };
    let mut file = Cursor::new(Vec::with_capacity(samples.len() * size + 128));
    let refused = |error: hound::Error| error.to_string();
    let mut writer = WavWriter::new(&mut file, spec).map_err(refused)?;
    for x in samples {
        match format {
            WavFormat::Pcm16 => {
                let full = f64::from(i16::MAX);
                writer.write_sample((x * full).round().clamp(-full, full) as i16)
            }
            WavFormat::Float32 => writer.write_sample(*x as f32),
        }
        .map_err(refused)?;
    }
    writer.finalize().map_err(refused)?;
    Ok(file.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use hound::WavReader;

    const SAMPLES: [f64; 6] = [0.0, 1.0, -1.0, 0.25, -1.5, 1e-9];

    #[test]
    fn sounds_round_trip() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.wav");
        write_wav(&path, 44_100, &SAMPLES, WavFormat::Float32).unwrap();
        let mut reader = WavReader::open(&path).unwrap();
        assert_eq!((reader.spec().channels, reader.spec().sample_rate), (1, 44_100));
        let floats: Vec<f32> = reader.samples().map(Result::unwrap).collect();
        assert_eq!(floats, SAMPLES.map(|x| x as f32));
        write_wav(&path, 8_000, &SAMPLES, WavFormat::Pcm16).unwrap();
        let mut reader = WavReader::open(&path).unwrap();
        assert_eq!((reader.spec().bits_per_sample, reader.spec().sample_rate), (16, 8_000));
        let integers: Vec<i16> = reader.samples().map(Result::unwrap).collect();
        assert_eq!(integers, [0, 32_767, -32_767, 8192, -32_767, 0]);
        write_wav(&path, 8_000, &[], WavFormat::Pcm16).unwrap();
        assert_eq!(WavReader::open(&path).unwrap().len(), 0);
    }

    #[test]
    fn invalid_sounds_are_rejected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.wav");
        for (rate, samples, cause) in [
            (8_000, [0.0, f64::NAN], "sample 1 is NaN: "),
            (8_000, [f64::INFINITY, 0.0], "sample 0 is inf: "),
            (8_000, [0.0, 1e300], "sample 1 is 1e300: "),
            (0, [0.0; 2], "the sound has 0 samples per second: "),
            (u32::MAX, [0.0; 2], "the sound has 4294967295 samples per second: "),
        ] {
            for format in [WavFormat::Pcm16, WavFormat::Float32] {
                let refused = write_wav(&path, rate, &samples, format).unwrap_err().to_string();
                assert!(refused.contains(&format!("a.wav: {cause}")), "{refused}");
            }
        }
        assert!(!path.exists());
    }
}
