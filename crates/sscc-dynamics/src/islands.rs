//! Islands: sets of bodies that contacts connect.

/// Bodies joined by contacts (a union-find forest).
#[derive(Clone, Debug, Default)]
pub(crate) struct Islands {
    parents: Vec<u32>,
}

impl Islands {
    /// Makes each body an island of its own.
    pub fn reset(&mut self, bodies: usize) {
        self.parents.clear();
        self.parents.extend(0..bodies as u32);
    }

    /// Returns the number of a body's island: that of its first body.
    pub fn of(&mut self, body: usize) -> usize {
        let mut n = body;
        while self.parents[n] as usize != n {
            // Halves the path.
            self.parents[n] = self.parents[self.parents[n] as usize];
            n = self.parents[n] as usize;
        }
        n
    }

    /// Joins the islands of two bodies.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.of(a), self.of(b));
        self.parents[a.max(b)] = a.min(b) as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn islands_join_bodies_that_are_connected() {
        let mut islands = Islands::default();
        islands.reset(7);
        for (a, b) in [(5, 3), (6, 1), (3, 6), (2, 4)] {
            islands.join(a, b);
        }
        assert_eq!([0, 1, 2, 3, 4, 5, 6].map(|n| islands.of(n)), [0, 1, 2, 1, 2, 1, 1]);
    }
}
