//! Which answers are wanted at a point: decided once, before anything is compiled.

/// A set of answers. The field is always among them.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Query {
    /// The gradient of the field.
    pub gradient: bool,
    /// Every attribute group of the model.
    pub attributes: bool,
}

impl Query {
    /// The field alone.
    pub const FIELD: Self = Self { gradient: false, attributes: false };
    /// Field and gradient.
    pub const GRADIENT: Self = Self { gradient: true, attributes: false };
    /// Field and attributes.
    pub const ATTRIBUTES: Self = Self { gradient: false, attributes: true };
    /// Field, gradient and attributes.
    pub const ALL: Self = Self { gradient: true, attributes: true };

    /// Every set of answers.
    pub const EVERY: [Self; 4] = [Self::FIELD, Self::GRADIENT, Self::ATTRIBUTES, Self::ALL];

    /// Its place in [`EVERY`](Self::EVERY).
    #[must_use]
    pub const fn index(self) -> usize {
        self.gradient as usize + 2 * self.attributes as usize
    }

    /// The word of the command line and of reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match (self.gradient, self.attributes) {
            (false, false) => "field",
            (true, false) => "gradient",
            (false, true) => "attributes",
            (true, true) => "all",
        }
    }
}
