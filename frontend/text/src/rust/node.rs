//! Nodes as Rust: constructors and methods of the builder.

use jbt_model::attribute::Precedence;
use jbt_model::combine::CombinatorKind;
use jbt_model::constant::LeafConstant;
use jbt_model::falloff::FalloffKind;
use jbt_model::field::{Field, FieldKind};
use jbt_model::number::Number;
use jbt_model::particles::{NumberArray, ParticleValues, PerParticle};
use jbt_model::tree::Tree;
use jbt_model::written::{
    FieldNumber, ParticleRadius, Radius, Written, WrittenAttribute, WrittenFalloff, WrittenParticles,
    WrittenTextured, WrittenUv,
};

use super::number::{RustBody, list, literal};

/// A tree in Rust.
#[derive(Clone)]
pub(super) struct RustTree {
    pub(super) text: String,
    /// Whether it is a variable, which is cloned where a value stands.
    pub(super) is_variable: bool,
}

impl RustTree {
    /// As a value of its own.
    pub(super) fn owned(&self) -> String {
        if self.is_variable { format!("{}.clone()", self.text) } else { self.text.clone() }
    }

    /// As what is lent.
    fn lent(&self) -> String {
        format!("&{}", self.text)
    }
}

impl RustBody {
    /// A node over children that are in Rust already.
    pub(super) fn node(&mut self, written: &Written, children: &[RustTree]) -> String {
        let nothing = RustTree { text: "Tree::empty()".to_owned(), is_variable: false };
        let child = children.first().unwrap_or(&nothing);
        match written {
            Written::Primitive { skeleton, fields, falloff, radius, strength } => {
                let mut arguments = self.arguments(skeleton.fields(), fields);
                arguments.push(match radius {
                    Radius::Support(radius) => self.number(radius),
                    Radius::Surface(radius) => format!("surface({})", self.number(radius)),
                });
                let mut text = format!("{}({})", skeleton.constructor(), arguments.join(", "));
                text.push_str(&self.lists(skeleton.fields(), fields));
                text.push_str(&self.of_leaf(falloff, Some(strength)));
                text
            }
            Written::Particles(particles) => self.particles(particles),
            Written::Combine { combinator, fields } => self.operator(*combinator, fields, children),
            Written::Select(which) => format!("Tree::select({}, {})", self.number(which), block(children)),
            Written::Expression(formula) if formula.is_zero() => nothing.text,
            Written::Expression(formula) => {
                let name = |place: usize| children.get(place).unwrap_or(&nothing).text.clone();
                let value = self.formula(formula, &name).join(", ");
                match formula.form.box_numbers(&formula.numbers) {
                    None => format!("Tree::expression({value})"),
                    Some(sides) => {
                        let [low, high] = [&sides[..3], &sides[3..]].map(|corner| self.numbers(corner));
                        format!("Tree::expression_within({value}, {low}, {high})")
                    }
                }
            }
            Written::Map { map, fields } => {
                let arguments = self.arguments(map.fields(), fields).join(", ");
                format!("{}.{}({arguments})", child.text, map.constructor())
            }
            Written::Warp { warp, fields } => {
                let arguments = self.arguments(warp.fields(), fields).join(", ");
                let text = format!("{}.{}({arguments})", child.text, warp.constructor());
                weighted(text, children)
            }
            Written::FormulaWarp(formula) => {
                let values = list(self.formula(formula, &|_| nothing.text.clone()));
                weighted(format!("{}.warp({values})", child.text), children)
            }
            Written::Attribute { name, value, precedence } => {
                let text = self.attribute(name, value);
                format!("{}.{text}{}", child.text, overriding(*precedence))
            }
            Written::Constant { name, value, precedence } => {
                let value = match value {
                    LeafConstant::Whole(number) => format!("{number}_i64"),
                    LeafConstant::Text(text) => format!("{text:?}"),
                };
                format!("{}.constant({name:?}, {value}){}", child.text, overriding(*precedence))
            }
        }
    }

    /// The lists and flags of a curve that are not as its constructor has them.
    fn lists(&mut self, fields: &[Field], values: &[FieldNumber]) -> String {
        let mut text = String::new();
        for (field, value) in fields.iter().zip(values) {
            match (field.kind, value) {
                (FieldKind::Lengths, FieldNumber::Reals(numbers)) if !numbers.is_empty() => {
                    text.push_str(&format!(".{}({})", field.name, self.numbers(numbers)));
                }
                (FieldKind::Flag, FieldNumber::Real(number)) if number.value() != 0.0 => {
                    text.push_str(&format!(".{}()", field.name));
                }
                _ => {}
            }
        }
        text
    }

    /// The falloff of a leaf and its strength, if they are not the usual ones.
    fn of_leaf(&mut self, falloff: &WrittenFalloff, strength: Option<&Number>) -> String {
        let mut text = String::new();
        if falloff.kind() != FalloffKind::Soft {
            text.push_str(&format!(".falloff({})", self.falloff(falloff)));
        }
        let is_one =
            |number: &&Number| !number.depends_on_parameters() && number.value().to_bits() == 1f64.to_bits();
        if let Some(strength) = strength.filter(|strength| !is_one(strength)) {
            text.push_str(&format!(".strength({})", self.number(strength)));
        }
        text
    }

    fn operator(
        &mut self,
        combinator: CombinatorKind,
        fields: &[FieldNumber],
        children: &[RustTree],
    ) -> String {
        let mut arguments = self.arguments(combinator.fields(), fields);
        let name = combinator.constructor();
        if let ([child], true) = (children, combinator.takes_one()) {
            return format!("{}.{name}({})", child.text, arguments.join(", "));
        }
        // These take two trees as methods; others have functions for any number.
        let mut function = if name == "ricci" { "blend" } else { name };
        if let Some(set) = name.strip_prefix("smooth_") {
            let (first, rest) = set.split_at(1);
            arguments.insert(0, format!("SetOperation::{}{rest}", first.to_uppercase()));
            function = "smooth";
        }
        arguments.push(block(children));
        format!("Tree::{function}({})", arguments.join(", "))
    }

    fn attribute(&mut self, name: &str, value: &WrittenAttribute) -> String {
        match value {
            WrittenAttribute::Numbers(numbers) if name == "color" && numbers.len() == 3 => {
                format!("color({})", self.numbers(numbers))
            }
            WrittenAttribute::Numbers(numbers) => format!("attribute({name:?}, &{})", self.numbers(numbers)),
            WrittenAttribute::Textured(WrittenTextured { texture, fields, a, b }) => {
                let arguments = self.arguments(texture.fields(), fields).join(", ");
                // Both lists have one type.
                let is_plain = a.iter().chain(b).all(|number| !number.depends_on_parameters());
                let mut end = |numbers: &[Number]| match is_plain {
                    true => self.numbers(numbers),
                    false => {
                        list(numbers.iter().map(|number| format!("Number::from({})", self.number(number))))
                    }
                };
                let (a, b) = (end(a), end(b));
                format!("textured({name:?}, {}({arguments}), &{a}, &{b})", texture.constructor())
            }
            WrittenAttribute::Uv(WrittenUv { scale, degrees, shift }) => {
                let mut both = |numbers: &[Number; 2]| {
                    list(numbers.iter().map(|number| format!("Number::from({})", self.number(number))))
                };
                let (scale, shift) = (both(scale), both(shift));
                format!("uv_mapped({name:?}, {scale}, {}, {shift})", self.number(degrees))
            }
            WrittenAttribute::Expressed(formula) => {
                let values = list(self.formula(formula, &|_| "Tree::empty()".to_owned()));
                format!("expressed({name:?}, {values})")
            }
        }
    }

    fn particles(&mut self, written: &WrittenParticles) -> String {
        let WrittenParticles { positions, radius, strength, falloff, values } = written;
        let (function, radius) = match radius {
            ParticleRadius::Support(radius) => ("particles", radius),
            ParticleRadius::Surface(radius) => ("surface_particles", radius),
        };
        let radius = match radius {
            PerParticle::All(number) => self.number(number),
            PerParticle::Each(numbers) => array(numbers),
        };
        let mut text = format!("{function}({}, {radius})", array(positions));
        text.push_str(&self.of_leaf(falloff, strength.all()));
        if let PerParticle::Each(numbers) = strength {
            text.push_str(&format!(".strengths({})", array(numbers)));
        }
        for ParticleValues { name, width, numbers } in &**values {
            text.push_str(&format!(".values({name:?}, {width}, {})", array(numbers)));
        }
        text
    }
}

/// What stands behind an attribute or a constant that overrides.
pub(super) const fn overriding(precedence: Precedence) -> &'static str {
    match precedence {
        Precedence::Nearest => "",
        Precedence::Override => ".overriding()",
    }
}

/// A warp with its weight, if it has one.
fn weighted(text: String, children: &[RustTree]) -> String {
    match children.get(1) {
        Some(weight) => format!("{text}.weighted({})", weight.lent()),
        None => text,
    }
}

/// The children of an operator, a line for each.
fn block(children: &[RustTree]) -> String {
    let lines: Vec<String> = children.iter().map(|child| format!("        {},\n", child.owned())).collect();
    format!("[\n{}    ]", lines.concat())
}

/// An array of plain numbers.
fn array(numbers: &NumberArray) -> String {
    format!("vec!{}", list(numbers.iter().map(literal)))
}

/// Whether a tree is an operator of several trees or a formula, which stand by themselves.
pub(super) fn is_operator(tree: &Tree) -> bool {
    match tree.node().written() {
        Written::Combine { combinator, .. } => !combinator.takes_one(),
        Written::Expression(formula) => !formula.is_zero(),
        Written::Select(_) => true,
        Written::Primitive { .. }
        | Written::Particles(_)
        | Written::Map { .. }
        | Written::Warp { .. }
        | Written::FormulaWarp(_)
        | Written::Attribute { .. }
        | Written::Constant { .. } => false,
    }
}
