//! The file of a proof, and the check of its entries. `docs/formats.md` has the format.

use std::iter;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::affine::AffineMap;
use crate::certificates::Certificates;
use crate::counted::{CountedPairs, Simplices};
use crate::directions::Directions;
use crate::dyadic::{Dyadic, Vector};
use crate::entries::Entry;
use crate::node_maps::{NodeMaps, bytes_of_map};
use crate::points::{Radius, Triangle, middles, quarters};
use crate::refusal::{IsCancelled, Refusal, Result, check_cancelled, claim, proof, require};
use crate::scaled::ScaledModel;

const MAGIC: &[u8; 8] = b"SSCCPRF1";
/// The largest depth of quarters within quarters.
const MAX_DEPTH: usize = 64;

/// Witnesses of node pairs.
const DIRECTION: u8 = b'd';
const NOTHING_COUNTS: u8 = b'n';
const SPLIT_FIRST: u8 = b'1';
const SPLIT_SECOND: u8 = b'2';
const TRIANGLES: u8 = b't';
/// Witnesses of triangle pairs; smaller numbers are the index of an earlier direction.
const NEW_DIRECTION: u8 = 255;
const NEW_MAP: u8 = 254;
const LAST_MAP: u8 = 253;
const QUARTER_FIRST: u8 = 252;
const QUARTER_SECOND: u8 = 251;

/// The parts of a proof.
pub(crate) struct Proof<'a> {
    /// The number of all entries, proven or not.
    pub(crate) entries: u64,
    maps: &'a [u8],
    /// The number of each proven entry, ascending, and its witnesses.
    pub(crate) proven: Vec<(usize, &'a [u8])>,
}

/// The bytes that have not been read yet.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        self.0.split_off(..count).ok_or_else(|| Refusal::Proof("it ends too early".into()))
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        Ok(self.take(N)?.try_into().unwrap_or([0; N]))
    }

    fn real(&mut self) -> Result<Dyadic> {
        let x = f64::from_le_bytes(self.array()?);
        claim(x.is_finite(), "a number is not finite")?;
        Ok(Dyadic::of(x))
    }

    fn vector(&mut self) -> Result<Vector> {
        Ok([self.real()?, self.real()?, self.real()?])
    }
}

impl<'a> Proof<'a> {
    /// Parses a proof, and checks its head before costly work: that it is of these certificates, and of a model with this rank.
    pub(crate) fn parse(bytes: &'a [u8], certificates: &Certificates, rank: usize) -> Result<Self> {
        require(bytes.iter().zip(MAGIC).all(|(a, b)| a == b), "not a proof of certificates")?;
        let mut bytes = Bytes(bytes);
        bytes.take(MAGIC.len())?;
        let digest = bytes.take(32)?;
        let [entries, count] = [u64::from_le_bytes(bytes.array()?), u64::from_le_bytes(bytes.array()?)];
        let size = [u32::from_le_bytes(bytes.array()?) as usize, u32::from_le_bytes(bytes.array()?) as usize];
        let maps = bytes.take(size[1].saturating_mul(bytes_of_map(size[0])))?;
        let mut proven: Vec<(usize, &[u8])> = Vec::new();
        for _ in 0..count {
            let index = u64::from_le_bytes(bytes.array()?);
            let length = u32::from_le_bytes(bytes.array()?);
            let is_next = proven.last().is_none_or(|(last, _)| (*last as u64) < index);
            if !is_next || index >= entries {
                return proof(format!("entry {index} is out of order, or does not exist"));
            }
            proven.push((index as usize, bytes.take(length as usize)?));
        }
        claim(bytes.0.is_empty(), "there are bytes after its end")?;
        claim(!proven.is_empty(), "it proves no entry")?;
        require(digest == certificates.digest, "of other certificates")?;
        let fits = size == [rank, certificates.nodes.len()];
        claim(fits, "it has another number of modes or nodes than the certificates")?;
        Ok(Self { entries, maps, proven })
    }

    /// Checks all entries that are proven, on several threads, or on fewer if the system refuses some. `entries`: all entries.
    pub(crate) fn check(
        &self,
        entries: &[Entry],
        counted: &CountedPairs<'_>,
        scaled: &ScaledModel,
        threads: usize,
        is_cancelled: &IsCancelled<'_>,
    ) -> Result<()> {
        let boxes = counted.certificates.nodes.iter().map(|_| OnceLock::new()).collect();
        let maps = &NodeMaps { counted, scaled, numbers: self.maps, boxes };
        let next = AtomicUsize::new(0);
        let take = || self.proven.get(next.fetch_add(1, Ordering::Relaxed));
        let refusal_of = |&(index, bytes): &(usize, &[u8])| {
            let radius = &scaled.radius(entries[index].radius);
            let (bytes, directions) = (Bytes(bytes), Directions::new(scaled, radius, threads));
            let mut reader = EntryReader { maps, is_cancelled, radius, bytes, directions, map: None };
            Some((index, reader.entry(entries[index]).err()?))
        };
        let work = || iter::from_fn(take).find_map(refusal_of);
        let refused = thread::scope(|scope| {
            // The system may refuse threads.
            let start = |_| thread::Builder::new().spawn_scoped(scope, work).ok();
            let started: Vec<_> = (1..threads).map_while(start).collect();
            let own = work();
            let failed = |_| Some((0, Refusal::Proof("a thread failed".into())));
            let others = started.into_iter().filter_map(|t| t.join().unwrap_or_else(failed));
            others.chain(own).min_by_key(|(index, _)| *index)
        });
        let Some((index, refusal)) = refused else { return Ok(()) };
        let Entry { nodes: [n, m], radius } = entries[index];
        Err(refusal.of(&format!("entry {index}, nodes {n} and {m}, radius {radius:e}")))
    }
}

/// Reads and checks the witnesses of an entry.
struct EntryReader<'a> {
    maps: &'a NodeMaps<'a>,
    is_cancelled: &'a IsCancelled<'a>,
    radius: &'a Radius,
    bytes: Bytes<'a>,
    /// The directions of the last list of triangles.
    directions: Directions<'a>,
    /// The last affine map of this list.
    map: Option<AffineMap>,
}

impl EntryReader<'_> {
    fn entry(&mut self, Entry { nodes, radius }: Entry) -> Result<()> {
        // An entry of radius 0 needs no witness.
        if radius > 0.0 {
            self.nodes(nodes)?;
        }
        claim(self.bytes.0.is_empty(), "there are witnesses after its end")
    }

    /// Checks all pairs between two nodes, or within one.
    fn nodes(&mut self, [n, m]: [u32; 2]) -> Result<()> {
        check_cancelled(self.is_cancelled)?;
        let children = |n: u32| self.maps.counted.certificates.nodes[n as usize].children();
        let has = |n: u32| !children(n).is_empty();
        match self.bytes.array()? {
            [DIRECTION] => {
                let dir = self.bytes.vector()?;
                let are_apart = n != m && self.maps.are_apart([n, m], &dir, self.radius);
                claim(are_apart, &format!("the direction does not separate nodes {n} and {m}"))
            }
            [NOTHING_COUNTS] => self.maps.counted.check_uncounted([n, m]),
            [SPLIT_FIRST] if n != m && has(n) => children(n).try_for_each(|child| self.nodes([child, m])),
            [SPLIT_SECOND] if n != m && has(m) => children(m).try_for_each(|child| self.nodes([n, child])),
            [TRIANGLES] if !has(n) && !has(m) => self.triangles([n, m]),
            [other] => proof(format!("{other} is no witness of nodes {n} and {m}")),
        }
    }

    /// Checks all pairs of triangles between two leaves, or within one.
    fn triangles(&mut self, nodes: [u32; 2]) -> Result<()> {
        self.directions.clear();
        self.map = None;
        let NodeMaps { counted, scaled, .. } = *self.maps;
        for [a, b] in counted.certificates.pairs(nodes) {
            for simplices in counted.simplices(a, b) {
                let corners = simplices.map(|simplex| simplex.map(|i| scaled.point(i)));
                if !self.parts(corners, Some(simplices), 0)? {
                    return proof(format!("the witness of triangles {a} and {b} does not hold"));
                }
            }
        }
        Ok(())
    }

    /// Whether the next witness holds for two triangles, or parts of them. `whole`: their vertices if they are simplices of the mesh.
    fn parts(&mut self, [x, y]: [Triangle<'_>; 2], whole: Option<Simplices>, depth: usize) -> Result<bool> {
        check_cancelled(self.is_cancelled)?;
        let scaled = self.maps.scaled;
        let [tag] = self.bytes.array()?;
        match tag {
            NEW_DIRECTION | ..QUARTER_SECOND => {
                let mut index = usize::from(tag);
                if tag == NEW_DIRECTION {
                    // Only as many directions are kept as have an index; a further one replaces the last.
                    index = self.directions.len().min(QUARTER_SECOND.into());
                    self.directions.set(index, self.bytes.vector()?);
                }
                Ok(match whole {
                    _ if index >= self.directions.len() => false,
                    Some(simplices) => self.directions.separate(index, simplices),
                    None => self.directions.separate_corners(index, [x, y]),
                })
            }
            QUARTER_FIRST | QUARTER_SECOND if depth < MAX_DEPTH => {
                let divided = if tag == QUARTER_FIRST { x } else { y };
                for part in quarters(divided, &middles(divided)) {
                    let pair = if tag == QUARTER_FIRST { [part, y] } else { [x, part] };
                    if !self.parts(pair, None, depth + 1)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            }
            NEW_MAP | LAST_MAP => {
                if tag == NEW_MAP {
                    let numbers = (0..9 * scaled.rank).map(|_| self.bytes.real());
                    self.map = Some(AffineMap::new(numbers.collect::<Result<_>>()?));
                }
                let (dir, rate) = (self.bytes.vector()?, self.bytes.real()?);
                let mut direction = || self.bytes.vector();
                let pyramid = [direction()?, direction()?, direction()?, direction()?];
                let Some(map) = &self.map else { return Ok(false) };
                Ok(map.separates(scaled, [x, y], &dir, &rate, &pyramid, self.radius))
            }
            _ => Ok(false),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use super::*;
    use crate::model::Model;
    use crate::scope::Scope;

    /// The number of entries of [`check`].
    const ENTRIES: usize = 200;

    /// Checks a proof of the same entry again and again, on this number of threads: two triangles one unit apart, which the mode
    /// brings together at 1, are separate below 1/2 by the direction along z. The numbered entry has a direction across.
    fn check(threads: usize, wrong: Option<usize>, is_cancelled: &IsCancelled<'_>) -> Result<()> {
        let corners = |z: f64| [[0.0, 0.0, z], [1.0, 0.0, z], [0.0, 1.0, z]];
        let mode = (0..18).map(|row| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 }).collect();
        let model = Model::new([corners(0.0), corners(1.0)].concat(), vec![[0, 1, 2], [3, 4, 5]], mode, 1)?;
        let scope = Scope::of_factor(vec![1.0], 1);
        let certificates = Certificates::of_leaf(2, 0.5);
        let counted = CountedPairs::new(&model, &scope, &certificates);
        let scaled = &ScaledModel::new(&model, &scope, &|| false)?;
        let witness = |dir: [f64; 3]| {
            let numbers = dir.into_iter().flat_map(f64::to_le_bytes);
            [TRIANGLES, NEW_DIRECTION].into_iter().chain(numbers).collect::<Vec<u8>>()
        };
        let (along, across) = (witness([0.0, 0.0, 1.0]), witness([1.0, 0.0, 0.0]));
        let bytes = |index: usize| if wrong == Some(index) { &across[..] } else { &along[..] };
        let proven = (0..ENTRIES).map(|index| (index, bytes(index))).collect();
        let file = Proof { entries: ENTRIES as u64, maps: &[], proven };
        let entries = [Entry { nodes: [0, 0], radius: 0.5 }; ENTRIES];
        file.check(&entries, &counted, scaled, threads, is_cancelled)
    }

    #[test]
    fn the_head_is_checked_before_all_else() {
        let certificates = Certificates::of_leaf(2, 0.5);
        let cause = |bytes: &[u8]| Proof::parse(bytes, &certificates, 1).err();
        let head = |rank: u32, nodes: u32, count: u64| {
            let numbers =
                [&2_u64.to_le_bytes()[..], &count.to_le_bytes(), &rank.to_le_bytes(), &nodes.to_le_bytes()];
            [&MAGIC[..], &[0; 32], &numbers.concat(), &vec![0; 8 * 15 * nodes as usize]].concat()
        };
        for bytes in [&b"x"[..], b"SSCCPRF2", b"SSCCPRX1 and more", b"{}"] {
            assert_eq!(cause(bytes), Some(Refusal::Input("not a proof of certificates".into())), "{bytes:?}");
        }
        let entry = [&1_u64.to_le_bytes()[..], &0_u32.to_le_bytes()].concat();
        let whole = [head(1, 1, 1), entry.clone()].concat();
        for length in 0..whole.len() {
            assert_eq!(cause(&whole[..length]), Some(Refusal::Proof("it ends too early".into())), "{length}");
        }
        assert_eq!(cause(&head(1, 1, 0)), Some(Refusal::Proof("it proves no entry".into())));
        assert!(matches!(cause(&[&whole[..], &entry].concat()), Some(Refusal::Proof(_))));
        assert!(matches!(cause(&[head(1, 1, 2), entry.clone(), entry].concat()), Some(Refusal::Proof(_))));
        // No memory is reserved for numbers that the file does not have.
        assert_eq!(cause(&head(u32::MAX, 1, u64::MAX)), Some(Refusal::Proof("it ends too early".into())));
        assert_eq!(cause(&whole), None);
        let mut other = whole.clone();
        other[8] ^= 1;
        assert_eq!(cause(&other), Some(Refusal::Input("of other certificates".into())));
        let two_nodes = [head(1, 2, 1), whole[whole.len() - 12..].to_vec()].concat();
        assert!(matches!(cause(&two_nodes), Some(Refusal::Proof(_))));
    }

    /// One thread is what remains if the system refuses all others.
    #[test]
    fn any_number_of_threads_checks_all_entries() {
        for threads in [1, 2, 7] {
            assert_eq!(check(threads, None, &|| false), Ok(()), "{threads} threads");
            for wrong in [0, 1, ENTRIES / 2, ENTRIES - 1] {
                let refusal = check(threads, Some(wrong), &|| false).unwrap_err();
                let Refusal::Proof(line) = &refusal else { panic!("{refusal}") };
                assert!(line.starts_with(&format!("entry {wrong}, nodes 0 and 0")), "{line}");
            }
        }
    }

    #[test]
    fn a_cancelled_check_ends_soon() {
        for threads in [1, 2, 7] {
            for most in [0, 1, 5, ENTRIES] {
                let (checks, is_cancelled) = (AtomicUsize::new(0), AtomicBool::new(false));
                let cancels = || {
                    if checks.fetch_add(1, Ordering::Relaxed) >= most {
                        is_cancelled.store(true, Ordering::Relaxed);
                    }
                    is_cancelled.load(Ordering::Relaxed)
                };
                assert_eq!(check(threads, None, &cancels), Err(Refusal::Cancelled), "{threads} threads");
                // Each thread ends at its next check.
                assert!(checks.load(Ordering::Relaxed) <= most + threads);
            }
        }
    }
}
