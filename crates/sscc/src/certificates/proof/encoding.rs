//! The bytes of a proof (docs/formats.md).

use glam::DVec3;

use crate::bounds::{NodeModes, PairWitness};
use crate::certificates::Digest;

const MAGIC: &[u8; 8] = b"SSCCPRF1";

// Tags of witnesses of node pairs.
pub(super) const DIRECTION: u8 = b'd';
pub(super) const NOTHING_COUNTS: u8 = b'n';
pub(super) const SPLIT_FIRST: u8 = b'1';
pub(super) const SPLIT_SECOND: u8 = b'2';
pub(super) const TRIANGLES: u8 = b't';

// Tags of witnesses of triangle pairs. A smaller byte is the number of an earlier direction.
const NEW_DIRECTION: u8 = 255;
const NEW_MAP: u8 = 254;
const LAST_MAP: u8 = 253;
const QUARTER_FIRST: u8 = 252;
const QUARTER_SECOND: u8 = 251;

/// The header, which comes before the entries.
pub(super) struct Header {
    pub(super) digest: Digest,
    pub(super) entries: usize,
    pub(super) proven: usize,
    pub(super) rank: usize,
    pub(super) nodes: usize,
}

pub(super) fn put_header(out: &mut Vec<u8>, header: &Header) {
    out.extend(MAGIC);
    out.extend(header.digest.0);
    [header.entries, header.proven].into_iter().for_each(|n| out.extend((n as u64).to_le_bytes()));
    [header.rank, header.nodes].into_iter().for_each(|n| out.extend((n as u32).to_le_bytes()));
}

/// Writes the affine map of a node.
pub(super) fn put_map(out: &mut Vec<u8>, node: &NodeModes, rank: usize) {
    put_vector(out, node.center);
    put_rows(out, &node.modes, 3, rank);
    put_rows(out, &node.gradient, 9, rank);
}

/// Writes rows without their padding.
fn put_rows(out: &mut Vec<u8>, rows: &[f64], count: usize, rank: usize) {
    for row in rows.chunks_exact(rows.len() / count) {
        row[..rank].iter().for_each(|x| put_real(out, *x));
    }
}

/// Writes a number, or 0 in place of one that is not finite: any witness may have a 0.
fn put_real(out: &mut Vec<u8>, x: f64) {
    out.extend((if x.is_finite() { x } else { 0.0 }).to_le_bytes());
}

pub(super) fn put_vector(out: &mut Vec<u8>, v: DVec3) {
    v.to_array().into_iter().for_each(|x| put_real(out, x));
}

/// Writes the witnesses of triangle pairs.
pub(super) fn put_witnesses(out: &mut Vec<u8>, witnesses: &[PairWitness], rank: usize) {
    let mut last: Option<&[f64]> = None;
    for witness in witnesses {
        match witness {
            PairWitness::Known(number) => out.push(*number as u8),
            PairWitness::Direction(dir) => {
                out.push(NEW_DIRECTION);
                put_vector(out, *dir);
            }
            PairWitness::Affine { gradient, dir, rate, pyramid } => {
                if last == Some(gradient) {
                    out.push(LAST_MAP);
                } else {
                    out.push(NEW_MAP);
                    put_rows(out, gradient, 9, rank);
                    last = Some(gradient);
                }
                put_vector(out, *dir);
                put_real(out, *rate);
                pyramid.iter().for_each(|u| put_vector(out, *u));
            }
            PairWitness::Quarters { is_first: true } => out.push(QUARTER_FIRST),
            PairWitness::Quarters { is_first: false } => out.push(QUARTER_SECOND),
        }
    }
}
