//! Which of several values counts where leaves are given more than one.

/// Which of several values of one name above a leaf counts.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
pub enum Precedence {
    /// The one that is nearest to the leaf, unless one above overrides it.
    #[default]
    Nearest,
    /// This one, whatever stands below; of several that override, the one that is nearest to the root.
    Override,
}
