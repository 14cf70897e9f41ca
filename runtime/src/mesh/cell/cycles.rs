//! The order of the crossed edges around each sheet of a cell.

use super::{ambiguous, inside, ring, ring_edges};

/// The cycles around the sheets of a cell, from its corners inside and its flipped faces, a bit each: for
/// each crossed edge the next edge of its sheet, counter-clockwise as seen from outside of the surface. For
/// any other edge the edge itself.
#[inline]
pub(crate) fn following(signs: u8, flips: u8) -> [u8; 12] {
    if flips == 0 { DEFAULT_FOLLOWING[usize::from(signs)] } else { cycles(signs, flips) }
}

/// The cycles of every case without flipped faces.
static DEFAULT_FOLLOWING: [[u8; 12]; 256] = {
    let mut following = [[0; 12]; 256];
    let mut signs = 0;
    while signs < 256 {
        following[signs] = cycles(signs as u8, 0);
        signs += 1;
    }
    following
};

const fn cycles(signs: u8, flips: u8) -> [u8; 12] {
    let mut next = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11];
    let mut face = 0;
    while face < 6 {
        // A segment joins the edge where the walk around the face enters the inside to the edge where it
        // leaves next; on a flipped face, to the edge where it left before.
        let back = flips >> face & 1 == 1 && ambiguous(signs, face);
        let (corners, edges) = (ring(face), ring_edges(face));
        let mut enter = 0;
        while enter < 4 {
            let mut leave = if crosses(signs, corners, enter, true) { 1 } else { 4 };
            while leave < 4 && !crosses(signs, corners, passed(enter, leave, back), false) {
                leave += 1;
            }
            if leave < 4 {
                let (enter, leave) = (edges[enter], edges[passed(enter, leave, back)]);
                // A ring goes counter-clockwise as seen from the high side of its axis. That is outside of
                // the cell only for high faces.
                let [from, to] = if face & 1 == 1 { [enter, leave] } else { [leave, enter] };
                next[from] = to as u8;
            }
            enter += 1;
        }
        face += 1;
    }
    next
}

/// The edge of a ring some steps behind another one, or before it.
const fn passed(edge: usize, steps: usize, back: bool) -> usize {
    (if back { edge + 4 - steps } else { edge + steps }) % 4
}

/// Whether an edge of a ring enters the inside, or leaves it.
const fn crosses(signs: u8, ring: [usize; 4], edge: usize, enters: bool) -> bool {
    let [from, to] = [inside(signs, ring[edge]), inside(signs, ring[(edge + 1) % 4])];
    from != to && to == enters
}
