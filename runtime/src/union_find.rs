//! Elements that are connected (union-find with halved paths: Tarjan and van Leeuwen 1984).

/// The element that stands for all that one is connected with. `roots` leads from each element to one that
/// is nearer to it, and shorter ways are left behind.
pub(crate) fn root(roots: &mut [u32], mut element: u32) -> u32 {
    while roots[element as usize] != element {
        let above = roots[roots[element as usize] as usize];
        roots[element as usize] = above;
        element = above;
    }
    element
}
