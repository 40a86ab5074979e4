//! Messages that name settings of a request as data, because each front end has its own names: flags, arguments, buttons.

use std::fmt;
use std::ops::Add;
use std::path;

macro_rules! settings {
    ($($setting:ident $name:literal),* $(,)?) => {
        /// A setting of a request. A message that names a setting advises to change it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[non_exhaustive]
        pub enum Setting {
            $(#[doc = concat!("The setting `", $name, "`.")] $setting,)*
        }

        impl Setting {
            /// All settings.
            pub const ALL: &[Self] = &[$(Self::$setting),*];

            /// Returns its name in Rust and in Python.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$setting => $name,)*
                }
            }
        }
    };
}

settings! {
    Against "against", AgainstMesh "against_mesh", Budget "budget", Cache "cache", Center "center", Clearance "clearance",
    Epsilon "epsilon",
    Fix "fix", Frames "frames", From "from", GroupBy "group_by", IgnoreGroups "ignore_groups", IgnoreRest "ignore_rest",
    Kind "kind", LocalBudget "local_budget", Material "material", MaxExceptions "max_exceptions", MeshName "mesh_name",
    Metric "metric", Models "models", Modes "modes", Node "node", OnlyGroups "only_groups", Out "out", Q "q",
    Range "range", Rank "rank", Reach "reach", Resolution "resolution", Restart "restart", Rings "rings", Scheme "scheme", Steps "steps",
    Threads "threads",
}

/// Text of a message, with settings in it. It is displayed with their names in Rust and in Python.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Setting(Setting),
}

impl Message {
    /// Returns the settings that the message names, in order.
    pub fn settings(&self) -> impl Iterator<Item = Setting> {
        self.0.iter().filter_map(|part| match part {
            Part::Text(_) => None,
            Part::Setting(setting) => Some(*setting),
        })
    }

    /// Returns the text with other names of settings.
    pub fn with_names(&self, name: impl Fn(Setting) -> String) -> String {
        let text = |part: &Part| match part {
            Part::Text(text) => text.clone(),
            Part::Setting(setting) => name(*setting),
        };
        self.0.iter().map(text).collect()
    }
}

impl fmt::Display for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.with_names(|setting| setting.name().into()))
    }
}

impl From<Setting> for Message {
    fn from(setting: Setting) -> Self {
        Self(vec![Part::Setting(setting)])
    }
}

macro_rules! from_text {
    ($($text:ty),*) => {
        $(impl From<$text> for Message {
            fn from(text: $text) -> Self {
                Self(vec![Part::Text(text.to_string())])
            }
        })*
    };
}

from_text!(&str, String, fmt::Arguments<'_>, path::Display<'_>);

impl<T: Into<Message>> Add<T> for Message {
    type Output = Self;

    fn add(mut self, end: T) -> Self {
        self.0.extend(end.into().0);
        self
    }
}

impl<T: Into<Message>> Add<T> for Setting {
    type Output = Message;

    fn add(self, end: T) -> Message {
        Message::from(self) + end
    }
}

impl Add<Setting> for &str {
    type Output = Message;

    fn add(self, setting: Setting) -> Message {
        Message::from(self) + setting
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_takes_the_names_of_its_front_end() {
        let message = "leave out " + Setting::MeshName + format!(" {}", 3);
        assert_eq!(message.to_string(), "leave out mesh_name 3");
        assert_eq!(message.with_names(|setting| format!("<{setting:?}>")), "leave out <MeshName> 3");
        assert!((Setting::Q + ": " + message).settings().eq([Setting::Q, Setting::MeshName]));
    }
}
