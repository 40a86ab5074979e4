//! Positions of vertices at the current q, or at both ends of a motion, each computed at most once for a query.

use glam::{DVec3, Vec4};

use crate::detect::frame::Frame;
use crate::detect::vertices::Vertices;
use crate::geometry::Aabb;
use crate::query::context::Ends;

#[derive(Clone)]
pub(crate) struct Positions<const E: usize> {
    query: u32,
    frame: Frame,
    exact: Vec<[DVec3; E]>,
    /// The positions in the frame.
    mapped: Vec<[Vec4; E]>,
    /// The query for which a position is current.
    queries: Vec<u32>,
}

impl<const E: usize> Positions<E> {
    pub(crate) fn new(count: usize) -> Self {
        Self {
            query: 0,
            frame: Frame::default(),
            exact: vec![[DVec3::ZERO; E]; count],
            mapped: vec![[Vec4::ZERO; E]; count],
            queries: vec![0; count],
        }
    }

    /// Starts a query, of a number that is not 0 and, unless it is 1, the one after the last; `around` is about where
    /// the shape is.
    pub(crate) fn update(&mut self, query: u32, around: Aabb) {
        if query == 1 {
            self.queries.fill(0);
        }
        self.query = query;
        self.frame = Frame::of(around);
    }

    /// Moves all vertices.
    pub(crate) fn move_all(&mut self, vertices: &Vertices, ends: &Ends<'_, E>) {
        self.queries.fill(self.query);
        // Four vertices side by side were no faster: this waits for memory.
        for (v, (x, mapped)) in self.exact.iter_mut().zip(&mut self.mapped).enumerate() {
            *x = placed(vertices.position(v as u32, ends.q), ends);
            *mapped = x.map(|x| self.frame.map(x));
        }
    }

    /// Moves a vertex, if it has not been.
    #[inline]
    pub(crate) fn move_one(&mut self, vertices: &Vertices, place: u32, ends: &Ends<'_, E>) {
        let i = place as usize;
        if self.queries[i] != self.query {
            self.exact[i] = match ends.ball {
                None => placed(vertices.position(place, ends.q), ends),
                Some(ball) => {
                    let ([x], reach) = (vertices.position(place, [ends.q[0]]), ball.of_vertex(place));
                    std::array::from_fn(|end| if end == 0 { x - reach } else { x + reach })
                }
            };
            self.mapped[i] = self.exact[i].map(|x| self.frame.map(x));
            self.queries[i] = self.query;
        }
    }

    /// Where moved vertices are at each end.
    #[inline]
    pub(crate) fn corners(&self, places: [u32; 3]) -> [[DVec3; 3]; E] {
        let corners = places.map(|v| &self.exact[v as usize]);
        std::array::from_fn(|end| corners.map(|x| x[end]))
    }

    /// The same in the frame.
    #[inline]
    pub(crate) fn mapped(&self, places: [u32; 3]) -> [[Vec4; E]; 3] {
        places.map(|v| self.mapped[v as usize])
    }

    /// The frame of the current query.
    #[inline]
    pub(crate) fn frame(&self) -> &Frame {
        &self.frame
    }
}

/// Positions in the world, where the shape has a pose there.
#[inline]
fn placed<const E: usize>(x: [DVec3; E], ends: &Ends<'_, E>) -> [DVec3; E] {
    match ends.pose {
        None => x,
        Some(placement) => x.map(|x| placement.pose.apply(x)),
    }
}
