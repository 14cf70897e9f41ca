//! What is set from outside a file of particles or atoms.

/// The field of a particle whose surface alone is at radius r.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub enum ParticleForm {
    /// The soft object (Wyvill, McPheeters and Wyvill 1986) at iso 1/2: 0 from a distance of 2 r on.
    #[default]
    Soft,
    /// Blinn's density of electrons (1982) at iso 1: `exp(-h (d^2 / r^2 - 1))` with this hardness h, which is
    /// cut at 4 r. For h of 2, what is cut is below 1e-13.
    Blinn(f64),
}

/// What is set from outside a file of particles or atoms.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct ParticleOptions {
    /// The radius of points that have none of their own.
    pub radius: Option<f64>,
    /// The factor of all radii of a file: 1 if nothing is said. 0.6 gives bonds of molecules a waist.
    pub scale: Option<f64>,
    /// The field of a particle.
    pub form: Option<ParticleForm>,
    /// Points are ellipsoids that follow the shape of their neighbourhood, which has this radius: the surface
    /// of a fluid is smooth then, and its sheets are thin (Yu and Turk 2013). Several times the distance of
    /// neighbours.
    pub anisotropic: Option<f64>,
    /// What the columns of a table are, in their order, instead of a head line: `x`, `y`, `z`, `radius`,
    /// `strength`, `r`, `g`, `b`, the name of an attribute, or `-` for one to leave out.
    pub columns: Vec<String>,
    /// Arrays of the file that become attributes, by name.
    pub values: Vec<String>,
    /// Keep the molecules of water that a structure was measured with.
    pub waters: bool,
    /// Which frame of a trajectory is read, from 1.
    pub frame: Option<usize>,
}

/// An option that only some formats of particles have a use for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum ParticleUse {
    Columns,
    Waters,
    Frame,
}

impl ParticleOptions {
    /// What files with a use for these options alone lack, of what is asked for.
    pub(in crate::import) fn useless(&self, uses: &[ParticleUse]) -> Option<&'static str> {
        let asked = [
            (!self.columns.is_empty(), ParticleUse::Columns, "no columns to name"),
            (self.waters, ParticleUse::Waters, "no water to keep"),
            (self.frame.is_some(), ParticleUse::Frame, "no frames to choose from"),
        ];
        asked.into_iter().find(|(is_set, kind, _)| *is_set && !uses.contains(kind)).map(|(.., what)| what)
    }

    /// Whether anything is set.
    pub(in crate::import) fn is_set(&self) -> bool {
        *self != Self::default()
    }
}
