//! Reads a scene from its TOML file.

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

/// Maximum size of a file (1 MiB).
const MAX_BYTES: usize = 1 << 20;

/// Maximum number of steps of a simulation.
const MAX_STEPS: f64 = 1e9;

/// Range of samples per second of a sound.
const RATES: RangeInclusive<f64> = 8000.0..=192_000.0;

/// Maximum number of samples of a sound, so that it fits a WAV file.
const MAX_SAMPLES: f64 = 1e9;

/// Factor on the rates of modes in a quick run.
const QUICK_SHAKE: f64 = 4.0;

/// Minimum number of steps in a period of contacts. Shorter contacts would end between two detections.
const MIN_CONTACT_STEPS: f64 = 4.0;

/// A scene. All numbers are finite and in their range.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name of the file without its extension.
    pub name: String,
    /// Its author's description.
    pub about: String,
    /// The hash of its text.
    pub digest: String,
    /// Seconds of a step.
    pub step: f64,
    /// Number of steps.
    pub steps: usize,
    /// Acceleration of gravity (m/s^2).
    pub gravity: DVec3,
    /// The ground, if the scene has one.
    pub ground: Option<Ground>,
    /// Options of contacts.
    pub contact: ContactOptions,
    /// The response to self-collisions.
    pub response: Response,
    /// Method of self-collision detection.
    pub detection: Detection,
    /// The models of its bodies.
    pub models: Vec<ModelSpec>,
    /// The bodies at the beginning.
    pub bodies: Vec<BodySpec>,
    /// Its sound, if the scene has sound.
    pub sound: Option<Sound>,
    /// Key frames of the animation per second.
    pub frames_per_second: f64,
}

/// The sound of all bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sound {
    /// Number of modes of the sound. It does not depend on that of the motion.
    pub modes: usize,
    /// Damping of these modes. None means the damping of the body.
    pub damping: Option<Damping>,
    /// Factor on the body's frequencies, as for a stiffer material.
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
    /// Returns the options of its world.
    pub fn options(&self) -> WorldOptions {
        let Self { step, gravity, ground, contact, response, .. } = *self;
        WorldOptions { step, gravity, ground, contact, response, ..WorldOptions::default() }
    }

    /// Shortens the scene for a quick run: at most a fifth of a second, with the small spring in place of each model,
    /// and with a stronger shake, so that it collides with itself.
    pub fn quicken(&mut self) {
        for model in &mut self.models {
            model.quicken();
        }
        for body in &mut self.bodies {
            body.shake.quicken(QUICK_SHAKE, models::QUICK_RANK);
        }
        self.steps = self.steps.min((0.2 / self.step).ceil() as usize);
        self.digest += " quick";
    }

    /// Replaces the response `contact` to self-collisions by `penalty`, as in the paper. The bodies then really collide
    /// with themselves, as benches of queries require.
    pub fn penetrate(&mut self) {
        if self.response == Response::Contact {
            self.response = Response::Penalty;
            self.digest += " penalty";
        }
    }

    /// Reads a scene. Names of files in it are relative to its own folder.
    ///
    /// # Errors
    /// When the file cannot be read, has more than 1 MiB or is not UTF-8; when it is not TOML, a key is missing or
    /// unknown, or a value is out of range: the error then names the line, and for an unknown key the nearest known
    /// one.
    pub fn read(path: &Path) -> Result<Self, SimError> {
        let bytes = read_whole(path)?;
        if bytes.len() > MAX_BYTES {
            let cause = format!("file has {} bytes; scenes may have at most {MAX_BYTES}", bytes.len());
            return Err(SimError::refused(path.display(), cause));
        }
        let text = str::from_utf8(&bytes).map_err(|error| {
            SimError::refused(
                format_args!("{}: not UTF-8 text: save it as UTF-8", path.display()),
                error.to_string(),
            )
        })?;
        Self::parse(path, text)
    }

    /// Reads a scene from the text of a file of this name.
    ///
    /// # Errors
    /// The errors of [`Scene::read`], except those of reading the file.
    pub fn parse(path: &Path, text: &str) -> Result<Self, SimError> {
        let source = Text { path, text };
        let table = DeTable::parse(text).map_err(|error| {
            source.refused(
                &error.span().unwrap_or_default(),
                error.message().lines().next().unwrap_or_default(),
            )
        })?;
        let scene = Section::new(source, &table, &KEYS)?;
        let rate = scene.require("steps_per_second", scene.positive("steps_per_second")?)?;
        let duration = scene.require("duration", scene.positive("duration")?)?;
        let steps = (duration * rate).round();
        if !(1.0..=MAX_STEPS).contains(&steps) {
            return Err(scene
                .refused("duration", format!("{steps:e} steps; a scene may have from 1 to {MAX_STEPS:e}")));
        }
        let contact = contact(&scene)?;
        if rate < MIN_CONTACT_STEPS * contact.frequency {
            let cause = format!(
                "the period of contacts of {} Hz is less than {MIN_CONTACT_STEPS} steps: raise steps_per_second, or \
                 lower the frequency of [contact]",
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

/// Methods of self-collision detection. All find the same pairs, so the motion does not depend on the method.
const DETECTIONS: [(&str, Detection); 5] = [
    ("certified", Detection::Certified),
    ("kinetic", Detection::Kinetic),
    ("traditional", Detection::Method(Method::Traditional)),
    ("bdtree", Detection::Method(Method::BdTree)),
    ("normal-cones", Detection::Method(Method::NormalCones)),
];

/// Reads the ground; z is up.
fn ground(scene: &Section<'_>) -> Result<Option<Ground>> {
    let Some(ground) = scene.section("ground", &["height", "friction"])? else { return Ok(None) };
    Ok(Some(Ground {
        normal: DVec3::Z,
        height: ground.number("height")?.unwrap_or(0.0),
        friction: ground.not_negative("friction")?.unwrap_or(Ground::default().friction),
    }))
}

/// The two names of the key of the number of solver iterations.
const ITERATIONS: [&str; 2] = ["iterations", "rounds"];

fn contact(scene: &Section<'_>) -> Result<ContactOptions> {
    let default = ContactOptions::default();
    let keys = ["frequency", "damping", "friction", "skin", "iterations", "rounds"];
    let Some(contact) = scene.section("contact", &keys)? else { return Ok(default) };
    Ok(ContactOptions {
        frequency: contact.positive("frequency")?.unwrap_or(default.frequency),
        damping: contact.not_negative("damping")?.unwrap_or(default.damping),
        friction: contact.not_negative("friction")?.unwrap_or(default.friction),
        skin: contact.positive("skin")?,
        iterations: contact.count(contact.either(ITERATIONS)?, 1000)?.unwrap_or(default.iterations),
    })
}

fn response(scene: &Section<'_>) -> Result<Response> {
    let words = [
        ("contact", Response::Contact),
        ("penalty", Response::Penalty),
        ("constrain", Response::Constrain),
        ("ignore", Response::Ignore),
    ];
    Ok(scene.word("response", &words)?.unwrap_or_default())
}

/// Reads the sound. Each step produces one sample.
fn sound(scene: &Section<'_>, rate: f64, steps: f64) -> Result<Option<Sound>> {
    let Some(sound) = scene.section("sound", &["modes", "damping", "pitch"])? else { return Ok(None) };
    if !RATES.contains(&rate) {
        let cause = format!("sound needs from {} to {} samples per second", RATES.start(), RATES.end());
        return Err(scene.refused("steps_per_second", cause));
    }
    if steps > MAX_SAMPLES {
        return Err(scene.refused("duration", format!("a sound has at most {MAX_SAMPLES:e} samples")));
    }
    Ok(Some(Sound {
        modes: sound.count("modes", models::MAX_RANK)?.unwrap_or(200),
        damping: models::damping(&sound)?,
        pitch: sound.positive("pitch")?.unwrap_or(1.0),
    }))
}
