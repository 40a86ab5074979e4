//! Set of bodies of a world.

/// Set of bodies of a world, by their numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodySet(Vec<bool>);

impl BodySet {
    /// Makes this the set of the bodies whose flag is set. `flags` has one for each body of the world.
    pub fn set(&mut self, flags: impl Iterator<Item = bool>) {
        self.0.clear();
        self.0.extend(flags);
    }

    /// Makes this the empty set of a world with `bodies` bodies.
    pub fn clear(&mut self, bodies: usize) {
        self.0.clear();
        self.0.resize(bodies, false);
    }

    pub fn insert(&mut self, body: usize) {
        self.0[body] = true;
    }

    pub fn contains(&self, body: usize) -> bool {
        self.0[body]
    }

    pub fn is_empty(&self) -> bool {
        !self.0.contains(&true)
    }

    /// Returns the numbers of the bodies of the set, ascending.
    pub fn members(&self) -> impl Iterator<Item = usize> {
        self.0.iter().enumerate().filter(|(_, flag)| **flag).map(|(n, _)| n)
    }

    /// Returns for each body of the world whether the set contains it.
    pub fn flags(&self) -> &[bool] {
        &self.0
    }

    /// Returns [`Self::flags`], mutable.
    pub fn flags_mut(&mut self) -> &mut [bool] {
        &mut self.0
    }
}
