//! A scene and how its TOML file is read.

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::str;

use glam::DVec3;
use sscc::Method;
use sscc_dynamics::{ContactOptions, Damping, Detection, Ground, Response, WorldOptions};
use sscc_io::read_whole;
use toml::de::DeTable;

use super::bodies::{self, BodySpec};
use super::models::{self, ModelSpec};
use super::section::{Section, Text};
use crate::error::{Result, SimError};

/// The largest file: 1 MiB.
const MOST_BYTES: usize = 1 << 20;

/// The most steps of a simulation.
const MOST_STEPS: f64 = 1e9;

/// Samples of a sound in a second.
const RATES: RangeInclusive<f64> = 8000.0..=192_000.0;

/// The most samples of a sound, so that it fits a WAV file.
const MOST_SAMPLES: f64 = 1e9;

/// A quick look shakes so many times as hard.
const QUICK_SHAKE: f64 = 4.0;

/// A contact must last so many steps of its period, else it is over before it is seen.
const LEAST_CONTACT_STEPS: f64 = 4.0;

/// A scene, as its file says it: all numbers are finite and in their range.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The file's name without its ending.
    pub name: String,
    /// Its author's description.
    pub about: String,
    /// The hash of its text.
    pub digest: String,
    /// Seconds of a step.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
    /// m/s^2.
    pub gravity: DVec3,
    /// The ground, if there is any.
    pub ground: Option<Ground>,
    /// How contacts push.
    pub contact: ContactOptions,
    /// The response to self-collisions.
    pub response: Response,
    /// How self-collisions are detected.
    pub detection: Detection,
    /// The models of its bodies.
    pub models: Vec<ModelSpec>,
    /// The bodies at the beginning.
    pub bodies: Vec<BodySpec>,
    /// Its sound, if there is any.
    pub sound: Option<Sound>,
    /// Key frames of the animation in a second.
    pub frames_per_second: f64,
}

/// The sound of all bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sound {
    /// Modes of the sound, more than those that move.
    pub modes: usize,
    /// Of them; none: that of the body.
    pub damping: Option<Damping>,
    /// So many times as high as the body's own frequencies: as if it were of a stiffer material.
    pub pitch: f64,
}

const KEYS: [&str; 12] = [
    "steps_per_second",
    "duration",
    "gravity",
    "ground",
    "contact",
    "response",
    "detection",
    "models",
    "bodies",
    "sound",
    "frames_per_second",
    "about",
];

impl Scene {
    /// The options of its world.
    pub fn options(&self) -> WorldOptions {
        let Self { step, gravity, ground, contact, response, .. } = *self;
        WorldOptions { step, gravity, ground, contact, response }
    }

    /// For a quick look: a small spring in place of any model, for half a second, shaken harder so that it touches
    /// itself.
    pub fn quicken(&mut self) {
        for model in &mut self.models {
            model.quicken();
        }
        for body in &mut self.bodies {
            body.shake.truncate(models::QUICK_RANK);
            body.shake.iter_mut().for_each(|speed| *speed *= QUICK_SHAKE);
        }
        self.steps = self.steps.min((0.5 / self.step).ceil() as usize);
        self.digest += " quick";
    }

    /// Reads a scene. Names of files in it are relative to its own folder.
    ///
    /// # Errors
    /// When the file cannot be read, is no TOML, has an unknown key (the error names the nearest known one), or a value
    /// out of range; with the line.
    pub fn read(path: &Path) -> Result<Self, SimError> {
        let bytes = read_whole(path)?;
        if bytes.len() > MOST_BYTES {
            let cause = format!("file has {} bytes; scenes may have at most {MOST_BYTES}", bytes.len());
            return Err(SimError::refused(path.display(), cause));
        }
        let text = str::from_utf8(&bytes).map_err(|error| {
            SimError::refused(format_args!("{}: no text", path.display()), error.to_string())
        })?;
        Self::parse(path, text)
    }

    /// As [`Scene::read`], of the text of a file of that name.
    ///
    /// # Errors
    /// As of [`Scene::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self, SimError> {
        let whole = Text { path, text };
        let table = DeTable::parse(text).map_err(|error| {
            whole.refused(
                &error.span().unwrap_or_default(),
                error.message().lines().next().unwrap_or_default(),
            )
        })?;
        let scene = Section::new(whole, &table, &KEYS)?;
        let rate = scene.wanted("steps_per_second", scene.positive("steps_per_second")?)?;
        let duration = scene.wanted("duration", scene.positive("duration")?)?;
        let steps = (duration * rate).round();
        if !(1.0..=MOST_STEPS).contains(&steps) {
            return Err(
                scene.refused("duration", format!("{steps:e} steps; from 1 to {MOST_STEPS:e} are possible"))
            );
        }
        let contact = contact(&scene)?;
        if rate < LEAST_CONTACT_STEPS * contact.frequency {
            let cause = format!(
                "the period of contacts of {} Hz is less than {LEAST_CONTACT_STEPS} of these steps: take more, or \
                 softer contacts",
                contact.frequency
            );
            return Err(scene.refused("steps_per_second", cause));
        }
        let folder = path.parent().map_or_else(PathBuf::new, Path::to_owned);
        let models: Vec<ModelSpec> = models::read(&scene, &folder)?;
        let bodies = bodies::read(&scene, &models)?;
        Ok(Self {
            name: path.file_stem().unwrap_or_default().to_string_lossy().into(),
            about: scene.text("about")?.unwrap_or_default().into(),
            digest: blake3::hash(text.as_bytes()).to_hex().to_string(),
            step: 1.0 / rate,
            steps: steps as usize,
            gravity: scene.vector("gravity")?.unwrap_or(DVec3::ZERO),
            ground: ground(&scene)?,
            contact,
            response: response(&scene)?,
            detection: scene.word("detection", &DETECTIONS)?.unwrap_or_default(),
            models,
            bodies,
            sound: sound(&scene, rate, steps)?,
            frames_per_second: scene.positive("frames_per_second")?.unwrap_or(60.0),
        })
    }
}

/// Ways to look for self-collisions. All find the same, so nothing else changes with them.
const DETECTIONS: [(&str, Detection); 5] = [
    ("certified", Detection::Certified),
    ("kinetic", Detection::Kinetic),
    ("traditional", Detection::Method(Method::Traditional)),
    ("bdtree", Detection::Method(Method::BdTree)),
    ("normal-cones", Detection::Method(Method::NormalCones)),
];

/// z is up.
fn ground(scene: &Section<'_>) -> Result<Option<Ground>> {
    let Some(ground) = scene.section("ground", &["height", "friction"])? else { return Ok(None) };
    Ok(Some(Ground {
        normal: DVec3::Z,
        height: ground.number("height")?.unwrap_or(0.0),
        friction: ground.not_negative("friction")?.unwrap_or(Ground::default().friction),
    }))
}

fn contact(scene: &Section<'_>) -> Result<ContactOptions> {
    let usual = ContactOptions::default();
    let keys = ["frequency", "damping", "friction", "skin", "rounds"];
    let Some(contact) = scene.section("contact", &keys)? else { return Ok(usual) };
    Ok(ContactOptions {
        frequency: contact.positive("frequency")?.unwrap_or(usual.frequency),
        damping: contact.not_negative("damping")?.unwrap_or(usual.damping),
        friction: contact.not_negative("friction")?.unwrap_or(usual.friction),
        skin: contact.positive("skin")?,
        rounds: contact.count("rounds", 1000)?.unwrap_or(usual.rounds),
    })
}

fn response(scene: &Section<'_>) -> Result<Response> {
    let words =
        [("contact", Response::Contact), ("constrain", Response::Constrain), ("ignore", Response::Ignore)];
    Ok(scene.word("response", &words)?.unwrap_or_default())
}

/// One sample is made at each step.
fn sound(scene: &Section<'_>, rate: f64, steps: f64) -> Result<Option<Sound>> {
    let Some(sound) = scene.section("sound", &["modes", "damping", "pitch"])? else { return Ok(None) };
    if !RATES.contains(&rate) {
        let cause = format!("sound needs from {} to {} samples in a second", RATES.start(), RATES.end());
        return Err(scene.refused("steps_per_second", cause));
    }
    if steps > MOST_SAMPLES {
        return Err(scene.refused("duration", format!("a sound has at most {MOST_SAMPLES:e} samples")));
    }
    Ok(Some(Sound {
        modes: sound.count("modes", models::MOST_RANK)?.unwrap_or(200),
        damping: models::damping(&sound)?,
        pitch: sound.positive("pitch")?.unwrap_or(1.0),
    }))
}
