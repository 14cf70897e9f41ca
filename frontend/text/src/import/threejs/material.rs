//! Materials of vertices, and how they are laid over a skeleton: colour, roughness and metalness become the
//! attributes `color`, `rough` and `metal`.

use jbt_model::attribute::{AttributeGroup, Mixing};
use jbt_model::diagnostic::Diagnostic;
use jbt_model::term::Term;
use jbt_model::tree::Tree;

use super::json::{JsonKind, JsonValue};
use super::reader::{SURFACE, TreeReader};
use crate::import::srgb;

/// A linear colour, roughness and metalness.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Material {
    color: [f64; 3],
    surface: [f64; SURFACE.len()],
}

/// What the library takes for a material that says nothing.
const GREY: f64 = 170.0 / 255.0;

impl TreeReader<'_> {
    /// Finds out which attributes the materials of the file ask for.
    pub(super) fn find_surface(&mut self) {
        self.surface = SURFACE.map(|(member, _)| self.json.has_number(member));
    }

    /// The attribute groups of the model.
    pub(super) fn groups(&self) -> Vec<AttributeGroup> {
        let asked = SURFACE.iter().zip(self.surface).filter(|(_, asked)| *asked);
        let groups = asked.map(|((_, name), _)| AttributeGroup {
            name: (*name).into(),
            default: vec![0.0],
            mixing: Mixing::Blend,
            ..AttributeGroup::color()
        });
        std::iter::once(AttributeGroup::color()).chain(groups).collect()
    }

    /// The materials of a node: as many as it has vertices.
    pub(super) fn materials<const N: usize>(&mut self, node: JsonValue) -> Result<[Material; N], Diagnostic> {
        let list = self.needed(node, "materials")?;
        let values: Vec<JsonValue> = self.json.values(list).take(N).collect();
        if values.len() < N {
            let error = self.error(list, format!("the node has {} materials", values.len()));
            return Err(error.expected(format!("expected {N}, one for each vertex")));
        }
        let mut materials = [Material { color: [0.0; 3], surface: [0.0; SURFACE.len()] }; N];
        for (material, value) in materials.iter_mut().zip(values) {
            *material = self.material(value)?;
        }
        Ok(materials)
    }

    fn material(&mut self, value: JsonValue) -> Result<Material, Diagnostic> {
        if self.json.kind(value) != JsonKind::Object {
            return Err(self.error(value, "a material is an object"));
        }
        let mut surface = [0.0; SURFACE.len()];
        for (slot, (member, _)) in surface.iter_mut().zip(SURFACE) {
            *slot = self.number_or(value, member, 0.0)?;
        }
        if let Some(emissive) = self.json.member(value, "emissive")
            && self.color(emissive)? != [0.0; 3]
        {
            self.left_out.note(self.json.span(emissive), "emissive colours of materials are left out");
        }
        let color = match self.json.member(value, "color") {
            Some(color) => self.color(color)?,
            None => [srgb::decoded(GREY); 3],
        };
        Ok(Material { color, surface })
    }

    /// `"#rrggbb"`, or a number of the same bits.
    fn color(&self, value: JsonValue) -> Result<[f64; 3], Diagnostic> {
        let bits = match self.json.kind(value) {
            JsonKind::Text => {
                let digits = self.json.text(value).strip_prefix('#').filter(|digits| digits.len() == 6);
                digits.and_then(|digits| u32::from_str_radix(digits, 16).ok())
            }
            JsonKind::Number => {
                let number = self.number(value)?;
                (number.fract() == 0.0 && (0.0..16_777_216.0).contains(&number)).then_some(number as u32)
            }
            JsonKind::Object | JsonKind::Array | JsonKind::Key | JsonKind::Word => None,
        };
        let Some(bits) = bits else {
            return Err(self.error(value, "this is no colour").expected("expected \"#rrggbb\""));
        };
        let channel = |shift: u32| srgb::decoded(f64::from(bits >> shift & 0xff) / 255.0);
        Ok([channel(16), channel(8), channel(0)])
    }

    /// A tree of one material, or of a mixture by the parts that the vertices have at each point, which add
    /// up to 1.
    pub(super) fn clothed(
        &self,
        tree: Tree,
        materials: &[Material],
        parts: impl FnOnce() -> Vec<Term>,
    ) -> Tree {
        let is_even = materials.iter().all(|material| *material == materials[0]);
        let parts = if is_even { Vec::new() } else { parts() };
        let mut tree = laid(&tree, "color", materials.iter().map(|material| material.color), &parts);
        for (at, (_, name)) in SURFACE.iter().enumerate().filter(|(at, _)| self.surface[*at]) {
            let values = materials.iter().map(|material| [material.surface[at]]);
            tree = laid(&tree, name, values, &parts);
        }
        tree
    }
}

/// A tree with an attribute by the values at its vertices.
fn laid<const N: usize>(
    tree: &Tree,
    name: &str,
    values: impl Iterator<Item = [f64; N]>,
    parts: &[Term],
) -> Tree {
    let values: Vec<[f64; N]> = values.collect();
    if values.iter().all(|value| *value == values[0]) {
        return tree.attribute(name, &values[0]);
    }
    let channel = |channel: usize| {
        let terms = parts.iter().zip(&values).map(|(part, value)| part * value[channel]);
        terms.reduce(|a, b| a + b).unwrap_or_else(|| 0.0.into())
    };
    tree.expressed(name, (0..N).map(channel))
}
