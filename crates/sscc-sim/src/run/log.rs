//! Log of the states of a simulation, and the checkpoint from which a stopped simulation continues.
//!
//! The log appends states of one size. A checkpoint holds their number, their hash, and the memory of the world and its
//! sounds. A continued simulation cuts off the states after the last checkpoint and computes them again, to the same
//! bits, so few checkpoints are enough. The cost of a checkpoint does not grow with the number of states.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use blake3::Hasher;
use sscc_io::{Message, Setting, read_whole, write_whole};

use super::history::{History, StateLayout};
use crate::error::{InSystem, Result, SimError};
use crate::files::{
    CHECKPOINT, LOG, check_others, is_checkpoint, of_others, output_of_others, remove_file, unsealed,
};

/// Size of the simulation's digest, with which both files begin (bytes).
const DIGEST: usize = 32;

/// Size of the hash of the states in a checkpoint (bytes).
const HASH: usize = 32;

/// The states of a simulation, on disk.
pub struct StateLog {
    folder: PathBuf,
    digest: [u8; DIGEST],
    layout: StateLayout,
    file: File,
    /// Number of complete states in the file.
    len: usize,
    /// The hash of these states.
    hasher: Hasher,
}

/// A checkpoint from which a simulation continues.
pub struct Checkpoint {
    /// Number of states.
    pub states: usize,
    /// The hash of these states.
    hasher: Hasher,
    /// The memory of the world and its sounds.
    pub memory: Vec<f64>,
}

impl StateLog {
    /// Opens the log of a folder. Returns it with the checkpoint, if the folder has one. `again` first removes the
    /// checkpoint and empties the log. `digest` is the digest of the simulation.
    ///
    /// # Errors
    /// When the folder cannot be written to, holds another simulation, or has files that are not of a simulation; when another
    /// simulation is writing to the log; when one of the files is damaged.
    pub(super) fn open(
        folder: &Path,
        digest: [u8; DIGEST],
        layout: StateLayout,
        again: bool,
    ) -> Result<(Self, Option<Checkpoint>)> {
        let path = folder.join(LOG);
        check_others(folder)?;
        let mut options = OpenOptions::new();
        let mut file =
            options.read(true).write(true).create(true).truncate(false).open(&path).system(&path)?;
        // Two simulations at once would overwrite each other's states.
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => {
                let cause = "another simulation is writing to this file: wait for it, or choose another folder with "
                    + Setting::Out;
                return Err(SimError::refused(path.display(), cause));
            }
            Err(TryLockError::Error(error)) => return Err(error).system(&path),
            Ok(()) => {}
        }
        let mut start = Vec::new();
        (&mut file).take(recognised_bytes() as u64).read_to_end(&mut start).system(&path)?;
        let is_own = start.starts_with(&digest);
        // A file without a state has nothing to lose: empty, or a digest alone, where a simulation was killed before it wrote a
        // state. Since any 32 bytes can be a digest, they do not vouch for other files. A checkpoint belongs to a damaged log.
        let is_known = start.is_empty()
            || start.len() == DIGEST && output_of_others(folder).is_none()
            || is_own
            || is_log(&start)
            || is_checkpoint(&folder.join(CHECKPOINT));
        if !is_known {
            return Err(of_others(&path));
        }
        if again {
            remove_file(&folder.join(CHECKPOINT))?;
            file.set_len(0).system(&path)?;
        } else if start.len() >= DIGEST && !is_own {
            let owner = "another scene, other models or another version of this program";
            return Err(of_another(&path, owner));
        }
        let mut log = Self { folder: folder.to_owned(), digest, layout, file, len: 0, hasher: Hasher::new() };
        let checkpoint = log.checkpoint()?;
        match &checkpoint {
            None => {
                log.file.set_len(0).system(&path)?;
                log.file.rewind().system(&path)?;
                log.file.write_all(&digest).system(&path)?;
            }
            Some(checkpoint) => {
                log.hasher = checkpoint.hasher.clone();
                log.cut(checkpoint.states)?;
            }
        }
        Ok((log, checkpoint))
    }

    /// Returns whether the folder has a checkpoint.
    pub fn is_begun(folder: &Path) -> bool {
        folder.join(CHECKPOINT).exists()
    }

    /// Reads the checkpoint of the folder, if there is one. Checks its hash, its digest, and the states in the log.
    fn checkpoint(&mut self) -> Result<Option<Checkpoint>> {
        let path = self.folder.join(CHECKPOINT);
        if !path.exists() {
            return Ok(None);
        }
        let bytes = read_whole(&path)?;
        let damaged = || damaged(&path);
        let content = unsealed(&bytes).ok_or_else(damaged)?;
        let (digest, rest) = content.split_at_checked(DIGEST).ok_or_else(damaged)?;
        if digest != self.digest {
            return Err(of_another(&path, "another simulation"));
        }
        let (of_states, rest) = rest.split_at_checked(HASH).ok_or_else(damaged)?;
        let ([states, memory @ ..], []) = rest.as_chunks::<8>() else { return Err(damaged()) };
        let states = usize::try_from(u64::from_le_bytes(*states)).map_err(|_| damaged())?;
        let log = self.path();
        let there = self.file.metadata().system(&log)?.len();
        let end = self.bytes(states).filter(|needed| *needed <= there).ok_or_else(|| {
            let cause = "the log beside this file has fewer states; begin again with " + Setting::Restart;
            SimError::refused(path.display(), cause)
        })?;
        let mut hasher = Hasher::new();
        self.file.seek(SeekFrom::Start(DIGEST as u64)).system(&log)?;
        hasher.update_reader((&self.file).take(end - DIGEST as u64)).system(&log)?;
        if hasher.finalize().as_bytes() != of_states {
            return Err(self::damaged(&log));
        }
        let memory = memory.iter().map(|x| f64::from_le_bytes(*x)).collect();
        Ok(Some(Checkpoint { states, hasher, memory }))
    }

    /// Returns the size of a log with this number of states (bytes).
    fn bytes(&self, states: usize) -> Option<u64> {
        let width = u64::try_from(8 * self.layout.width()).ok()?;
        u64::try_from(states).ok()?.checked_mul(width)?.checked_add(DIGEST as u64)
    }

    /// Truncates the log to this number of states, and seeks its end.
    fn cut(&mut self, states: usize) -> Result<()> {
        let path = self.path();
        let too_many = || SimError::refused(path.display(), format!("{states} states do not fit a file"));
        let end = self.bytes(states).ok_or_else(too_many)?;
        self.file.set_len(end).system(&path)?;
        self.file.seek(SeekFrom::Start(end)).system(&path)?;
        self.len = states;
        Ok(())
    }

    fn path(&self) -> PathBuf {
        self.folder.join(LOG)
    }

    /// Returns the number of states.
    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Appends whole states.
    pub(super) fn append(&mut self, numbers: &[f64]) -> Result<()> {
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.file.write_all(&bytes).system(&self.path())?;
        self.hasher.update(&bytes);
        self.len += numbers.len() / self.layout.width();
        Ok(())
    }

    /// Writes a checkpoint of all states so far.
    pub(super) fn write_checkpoint(&mut self, memory: &[f64]) -> Result<()> {
        // States are written first: a checkpoint must not count states that are not on the disk.
        self.file.sync_data().system(&self.path())?;
        let mut bytes = self.digest.to_vec();
        bytes.extend(self.hasher.finalize().as_bytes());
        bytes.extend((self.len as u64).to_le_bytes());
        bytes.extend(memory.iter().flat_map(|x| x.to_le_bytes()));
        let seal = blake3::hash(&bytes);
        bytes.extend(seal.as_bytes());
        Ok(write_whole(&self.folder.join(CHECKPOINT), &bytes)?)
    }

    /// Reads all states.
    pub(super) fn history(&mut self) -> Result<History> {
        let path = self.path();
        let mut bytes = vec![0; self.len * self.layout.width() * 8];
        self.file.seek(SeekFrom::Start(DIGEST as u64)).system(&path)?;
        self.file.read_exact(&mut bytes).system(&path)?; // the file is at its end again
        let numbers = bytes.as_chunks().0.iter().map(|x| f64::from_le_bytes(*x)).collect();
        Ok(History::new(self.layout.clone(), numbers))
    }
}

/// Layout of the first values of every log: the record of the first step, and its first body without its q.
fn first_layout() -> StateLayout {
    StateLayout::new([0])
}

/// Returns the number of bytes by which [`is_log`] recognises a log.
fn recognised_bytes() -> usize {
    DIGEST + 8 * first_layout().width()
}

/// Whether a file begins like the log of any simulation: a digest, then a state, whose step took time and whose first body has a
/// rotation of length 1. A log has no magic number, and other files do not have these numbers in these places.
fn is_log(start: &[u8]) -> bool {
    let Some(state) = start.get(DIGEST..recognised_bytes()) else { return false };
    let numbers = state.as_chunks().0.iter().map(|x| f64::from_le_bytes(*x)).collect();
    let history = History::new(first_layout(), numbers);
    let (step, body) = (history.step(0), history.body(0, 0));
    let has_time = step.wall > 0.0 && step.wall.is_finite();
    has_time && body.position.is_finite() && body.orientation.is_normalized()
}

fn damaged(path: &Path) -> SimError {
    SimError::refused(path.display(), "this file is damaged; begin again with " + Setting::Restart)
}

fn of_another(path: &Path, owner: &str) -> SimError {
    let cause = format!("this file belongs to {owner}: choose another folder, or begin again with ");
    SimError::refused(path.display(), Message::from(cause) + Setting::Restart)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use glam::{DQuat, DVec3};

    use super::super::history::{BodyRecord, StepRecord};
    use super::*;

    fn open(folder: &Path, digest: u8) -> Result<(StateLog, Option<Checkpoint>)> {
        StateLog::open(folder, [digest; DIGEST], StateLayout::new([1]), false)
    }

    /// Returns a state of the layout, 20 numbers.
    fn state(x: f64) -> Vec<f64> {
        (0..20).map(|i| x + f64::from(i)).collect()
    }

    #[test]
    fn a_killed_simulation_continues_from_its_checkpoint() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let (mut log, none) = open(path, 1).unwrap();
        assert!(none.is_none());
        log.append(&[state(0.0), state(100.0)].concat()).unwrap();
        log.write_checkpoint(&[0.5, -1.0]).unwrap();
        log.append(&state(200.0)).unwrap();
        log.file.write_all(b"half a st").unwrap();
        assert!(open(path, 1).err().unwrap().to_string().contains("another simulation is writing"));
        drop(log);

        let (mut log, checkpoint) = open(path, 1).unwrap();
        let Checkpoint { states, memory, .. } = checkpoint.unwrap();
        assert_eq!((states, log.len(), memory), (2, 2, vec![0.5, -1.0]));
        log.append(&state(300.0)).unwrap();
        let history = log.history().unwrap();
        assert_eq!((history.len(), history.body(2, 0).q), (3, &[319.0][..]));
        // History leaves the log at its end.
        log.append(&state(400.0)).unwrap();
        assert_eq!(log.history().unwrap().body(3, 0).q, [419.0]);
        log.write_checkpoint(&[]).unwrap();
        drop(log);
        assert_eq!(open(path, 1).unwrap().1.unwrap().states, 4);
    }

    /// Returns a first state as a simulation writes it.
    fn first_state() -> Vec<f64> {
        let body = BodyRecord {
            pairs: 0,
            position: DVec3::new(0.0, 0.0, 0.2),
            orientation: DQuat::from_rotation_x(1.0),
            q: &[0.5],
        };
        let mut numbers = Vec::new();
        let record = StepRecord { wall: 1e-4, energy: 1.5, ..StepRecord::default() };
        StateLayout::new([1]).push(record, [body], &mut numbers);
        numbers
    }

    /// A simulation that was killed before its first checkpoint leaves its log alone.
    #[test]
    fn logs_of_other_simulations_are_recognised_without_a_checkpoint() {
        let folder = tempfile::tempdir().unwrap();
        let (mut log, _) = open(folder.path(), 1).unwrap();
        log.append(&first_state()).unwrap();
        drop(log);
        let message = open(folder.path(), 2).err().unwrap().to_string();
        assert!(message.contains("states.log: this file belongs to another scene"), "{message}");
        let again = StateLog::open(folder.path(), [2; DIGEST], StateLayout::new([1]), true).unwrap();
        assert!(again.1.is_none() && again.0.len() == 0);
        drop(again);
        // So is one that was killed before its first state.
        let message = open(folder.path(), 3).err().unwrap().to_string();
        assert!(message.contains("states.log: this file belongs to another scene"), "{message}");
        drop(StateLog::open(folder.path(), [2; DIGEST], StateLayout::new([1]), true).unwrap());
        // The same simulation also continues from a log without a state.
        assert_eq!(fs::read(folder.path().join(LOG)).unwrap(), [2; DIGEST]);
        assert!(open(folder.path(), 2).unwrap().1.is_none());
    }

    #[test]
    fn a_log_of_another_program_is_refused_and_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(LOG);
        let text = "2026-11-28 12:00:00 state 17: idle\n".repeat(20);
        let ones: Vec<u8> = [1.0_f64; 60].iter().flat_map(|x| x.to_le_bytes()).collect();
        let text = text.as_bytes();
        let cases: [&[u8]; 5] = [text, &text[..1], &text[..DIGEST + 1], &ones, &[0; 400]];
        for bytes in cases {
            fs::write(&path, bytes).unwrap();
            for again in [false, true] {
                let refused = StateLog::open(folder.path(), [1; DIGEST], StateLayout::new([1]), again);
                let message = refused.err().unwrap().to_string();
                let cause = "states.log: exists and is not of a simulation: choose another folder with out";
                assert!(message.contains(cause), "{message}");
                assert_eq!(fs::read(&path).unwrap(), bytes);
            }
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        // An empty file has nothing to lose.
        fs::write(&path, b"").unwrap();
        assert!(open(folder.path(), 1).is_ok());
        // 32 bytes may be a digest, but say nothing about a file beside them.
        fs::write(&path, &text[..DIGEST]).unwrap();
        fs::write(folder.path().join("report.html"), b"x").unwrap();
        let refused = StateLog::open(folder.path(), [1; DIGEST], StateLayout::new([1]), true);
        assert!(refused.err().unwrap().to_string().contains("states.log: exists and is not of a simulation"));
        assert_eq!(fs::read(&path).unwrap(), &text[..DIGEST]);
    }

    #[test]
    fn files_of_other_simulations_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        let (mut log, _) = open(path, 1).unwrap();
        log.append(&state(0.0)).unwrap();
        log.write_checkpoint(&[1.0]).unwrap();
        drop(log);
        let message = |digest| open(path, digest).err().unwrap().to_string();
        assert!(message(2).contains("another folder, or begin again with restart"));
        let good = fs::read(path.join(CHECKPOINT)).unwrap();
        for at in [0, 33, 41, good.len() - 1] {
            let mut bad = good.clone();
            bad[at] ^= 1;
            fs::write(path.join(CHECKPOINT), bad).unwrap();
            assert!(message(1).contains("this file is damaged"));
        }
        for len in [1, 31, 64, 70, good.len() - 1] {
            fs::write(path.join(CHECKPOINT), &good[..len]).unwrap();
            assert!(message(1).contains("this file is damaged"), "{len}");
        }
        fs::write(path.join(CHECKPOINT), &good).unwrap();
        let states = fs::read(path.join(LOG)).unwrap();
        for at in [DIGEST, DIGEST + 70, states.len() - 1] {
            let mut bad = states.clone();
            bad[at] ^= 1;
            fs::write(path.join(LOG), bad).unwrap();
            assert!(message(1).contains("states.log: this file is damaged"));
        }
        fs::write(path.join(LOG), &states).unwrap();
        assert!(open(path, 1).is_ok());
        fs::write(path.join(LOG), [1; DIGEST]).unwrap();
        assert!(message(1).contains("the log beside this file has fewer states"));
        // A log that another simulation writes is refused, too.
        let again = || StateLog::open(path, [2; DIGEST], StateLayout::new([1]), true);
        let (log, none) = again().unwrap();
        assert!(none.is_none() && log.len() == 0);
        assert!(again().err().unwrap().to_string().contains("another simulation is writing"));
        drop(log);
        assert!(again().unwrap().1.is_none());
    }
}
