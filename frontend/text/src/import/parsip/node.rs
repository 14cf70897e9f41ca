//! The meaning of one node: its map, its leaf, its operator.

use std::fmt::Write as _;

use glam::{DAffine3, DQuat, DVec3};

use super::scan::{Key, Section};
use super::state::{Importer, Meaning};
use super::warp::WarpName;
use jbt_model::affine::scale_rotate_translate;
use jbt_model::combine::{Combinator, Difference, Intersection, Ricci, Sum, Union};
use jbt_model::diagnostic::{Diagnostic, Span};
use jbt_model::falloff::Falloff;
use jbt_model::kind::Primitive;
use jbt_model::report::{clip, nearest};
use jbt_model::skeleton::{self, Cylinder, Disc, Point, Ring, Segment, Skeleton, Triangle};

/// The meaning of an operator's name.
#[derive(Clone, Copy, PartialEq, Debug)]
enum OperatorName {
    /// A combinator without parameters.
    Combine(Combinator),
    Ricci,
    /// The child as it is.
    Pass,
    Warp(WarpName),
    SmoothDifference,
    /// An operator that this project lacks: its effect.
    Foreign(&'static str),
}

const OPERATORS: &[(&str, OperatorName)] = &[
    ("UNION", OperatorName::Combine(Combinator::Union(Union {}))),
    ("INTERSECTION", OperatorName::Combine(Combinator::Intersection(Intersection {}))),
    ("DIFFERENCE", OperatorName::Combine(Combinator::Difference(Difference {}))),
    ("SMOOTH DIFFERENCE", OperatorName::SmoothDifference),
    ("BLEND", OperatorName::Combine(Combinator::Sum(Sum {}))),
    ("GRADIENT BLEND", OperatorName::Combine(Combinator::Sum(Sum {}))),
    ("RICCI BLEND", OperatorName::Ricci),
    ("FASTQUADRICPOINTSET", OperatorName::Combine(Combinator::Sum(Sum {}))),
    ("FASTQUADRATICPOINTSET", OperatorName::Combine(Combinator::Sum(Sum {}))),
    ("PCM", OperatorName::Foreign("contact of two bodies, by the greatest compression over the whole model")),
    ("CACHE", OperatorName::Pass),
    ("TEXTURE", OperatorName::Pass),
    ("TWIST", OperatorName::Warp(WarpName::Twist)),
    ("TAPER", OperatorName::Warp(WarpName::Taper)),
    ("SHEAR", OperatorName::Warp(WarpName::Shear)),
    ("BEND", OperatorName::Warp(WarpName::Bend)),
];

/// The meaning of a leaf's name.
#[derive(Clone, Copy, PartialEq, Debug)]
enum LeafName {
    Point,
    Line,
    Cylinder,
    Disc,
    Ring,
    Cube,
    Triangle,
    Null,
    Instance,
    /// A ball with a falloff, a radius and a strength of its own.
    QuadricPoint,
}

const LEAVES: &[(&str, LeafName)] = &[
    ("POINT", LeafName::Point),
    ("LINE", LeafName::Line),
    ("CYLINDER", LeafName::Cylinder),
    ("DISC", LeafName::Disc),
    ("RING", LeafName::Ring),
    ("CUBE", LeafName::Cube),
    ("TRIANGLE", LeafName::Triangle),
    ("QUADRICPOINT", LeafName::QuadricPoint),
    ("NULL", LeafName::Null),
    ("INSTANCE", LeafName::Instance),
];

/// A node, without its children.
pub(super) struct Reading {
    /// Its meaning; `None` after a message.
    pub(super) meaning: Option<Meaning>,
    /// The nodes below it, and the place where they are named.
    pub(super) children: Vec<u32>,
    pub(super) reference: Span,
    /// The map to the parent's space, unless it is the identity.
    pub(super) map: Option<DAffine3>,
}

impl Importer<'_> {
    /// Reads one node.
    pub(super) fn node(&mut self, section: &Section) -> Reading {
        let map = self.map(section);
        let operator = match section.get(Key::IsOperator) {
            Some(_) => self.flag(section, Key::IsOperator),
            None => section.get(Key::OperatorType).is_some(),
        };
        let mut reading = Reading { meaning: None, children: Vec::new(), reference: section.span, map };
        if operator {
            self.operator(section, &mut reading);
        } else {
            self.leaf(section, &mut reading);
        }
        reading
    }

    /// The map of a node: scale first, then rotation, then translation. The quaternion is normalised.
    fn map(&mut self, section: &Section) -> Option<DAffine3> {
        let scale = self.tuple::<3>(section, Key::Scale, 0).map_or(DVec3::ONE, DVec3::from);
        let rotation = self.tuple::<4>(section, Key::Rotate, 0).map_or(DQuat::IDENTITY, DQuat::from_array);
        let translation = self.tuple::<3>(section, Key::Translate, 0).map_or(DVec3::ZERO, DVec3::from);
        if scale.cmpeq(DVec3::ZERO).any() {
            let (span, id) = (section.get(Key::Scale), section.id);
            self.errors.add(|| Diagnostic::error(span, format!("node {id} has a scale factor of zero")));
            return None;
        }
        if rotation.length_squared() < f64::MIN_POSITIVE {
            let (span, id) = (section.get(Key::Rotate), section.id);
            self.errors.add(|| {
                Diagnostic::error(span, format!("the rotation of node {id} is zero"))
                    .expected("expected a quaternion (x, y, z, w)")
            });
            return None;
        }
        let map = scale_rotate_translate(scale, rotation, translation);
        (map != DAffine3::IDENTITY).then_some(map)
    }

    /// The name of a node's type, and where it stands.
    fn type_name(&mut self, section: &Section, keys: &[Key]) -> Option<(String, Span)> {
        let found = keys.iter().find_map(|&key| section.get(key));
        let span = match found {
            Some(span) => span,
            None => self.need(section, keys[0])?,
        };
        Some((self.shown(span), span))
    }

    /// Looks a name up. An unknown name is an error.
    fn look_up<T: Copy>(&mut self, what: &str, name: &str, span: Span, table: &[(&str, T)]) -> Option<T> {
        let found = table.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
        if found.is_none() {
            self.errors.add(|| {
                let mut help = String::new();
                if let Some(near) = nearest(name, table.iter().map(|(known, _)| *known)) {
                    let _ = write!(help, "perhaps {near}; ");
                }
                let known: Vec<&str> = table.iter().map(|(known, _)| *known).collect();
                let _ = write!(help, "known are {}", known.join(", "));
                Diagnostic::error(Some(span), format!("no {what} is called {}", clip(name))).expected(help)
            });
        }
        found.map(|&(_, value)| value)
    }

    fn foreign(&mut self, name: &str, span: Span, does: &str) {
        self.errors.add(|| {
            Diagnostic::error(Some(span), format!("{name} ({does}) has no counterpart in this model format"))
        });
    }

    fn operator(&mut self, section: &Section, reading: &mut Reading) {
        self.children(section, reading);
        let Some((name, span)) = self.type_name(section, &[Key::OperatorType]) else {
            return;
        };
        let Some(operator) = self.look_up("operator", &name, span, OPERATORS) else {
            return;
        };
        let unary = match operator {
            OperatorName::Pass | OperatorName::Warp(_) => true,
            OperatorName::Combine(_)
            | OperatorName::Ricci
            | OperatorName::SmoothDifference
            | OperatorName::Foreign(_) => false,
        };
        let (id, reference, count) = (section.id, reading.reference, reading.children.len());
        if unary && count > 1 {
            self.errors.add(|| {
                Diagnostic::error(Some(reference), format!("{name} of node {id} has {count} children"))
                    .expected("expected one")
            });
            return;
        }
        reading.meaning = match operator {
            OperatorName::Combine(combinator) => Some(Meaning::Combine(combinator)),
            OperatorName::Ricci => {
                let power = self.number(section, Key::Power).unwrap_or(0.0);
                let exponent = if power == 0.0 { 2.0 } else { power };
                Some(Meaning::Combine(Ricci { exponent }.into()))
            }
            OperatorName::Pass => Some(Meaning::Same),
            OperatorName::Warp(name) => self.warp(section, name),
            OperatorName::SmoothDifference => {
                self.first_colored(section);
                Some(Meaning::SmoothDifference)
            }
            OperatorName::Foreign(does) => {
                self.foreign(&name, span, does);
                None
            }
        };
    }

    fn leaf(&mut self, section: &Section, reading: &mut Reading) {
        let Some((name, span)) = self.type_name(section, &[Key::PrimitiveType, Key::SkeletonType]) else {
            return;
        };
        let Some(leaf) = self.look_up("primitive", &name, span, LEAVES) else {
            return;
        };
        let strength = if leaf == LeafName::Null { 0.0 } else { 1.0 };
        let skeleton = match leaf {
            LeafName::Instance => {
                if let Some(span) = self.need(section, Key::Original)
                    && let Some(original) = self.integer(section, Key::Original)
                {
                    reading.reference = span;
                    reading.children.extend(self.find(original, span));
                    reading.meaning = Some(Meaning::Same);
                }
                return;
            }
            LeafName::QuadricPoint => {
                reading.meaning = self.quadric_point(section, reading.map.is_some());
                return;
            }
            LeafName::Null => Some(Point { at: DVec3::ZERO }.into()),
            LeafName::Point
            | LeafName::Line
            | LeafName::Cylinder
            | LeafName::Disc
            | LeafName::Ring
            | LeafName::Cube
            | LeafName::Triangle => self.skeleton(section, leaf),
        };
        let color = self.tuple::<3>(section, Key::Diffused, 1);
        reading.meaning = skeleton.map(|skeleton| {
            let leaf = Primitive { skeleton, falloff: Falloff::Wyvill, radius: 1.0, strength };
            Meaning::Leaf { leaf, color: color.filter(|_| strength != 0.0) }
        });
    }

    /// A point with the field `scale * (1 - d^2 / radius^2)^2`.
    fn quadric_point(&mut self, section: &Section, is_mapped: bool) -> Option<Meaning> {
        let at = self.tuple::<3>(section, Key::Position, 0).map_or(DVec3::ZERO, DVec3::from);
        let radius = self.length(section, Key::Radius)?;
        let strength = match section.get(Key::FieldScale) {
            Some(_) => self.number(section, Key::FieldScale)?,
            None => 1.0,
        };
        if is_mapped {
            self.departs(section, "leaves out the map of a QUADRICPOINT; here it counts");
        }
        let color = self.tuple::<3>(section, Key::Diffused, 1);
        let leaf = Primitive { skeleton: Point { at }.into(), falloff: Falloff::Quartic, radius, strength };
        Some(Meaning::Leaf { leaf, color })
    }

    /// Warns of the colour of a smooth difference.
    fn first_colored(&mut self, section: &Section) {
        let (id, span) = (section.id, section.get(Key::OperatorType));
        self.warnings.add(|| {
            let message =
                format!("the smooth difference of node {id} has the colour of its first child, cuts too");
            Diagnostic::warning(span, message)
        });
    }

    /// The skeleton of a leaf that has one. `None` after a message.
    fn skeleton(&mut self, section: &Section, leaf: LeafName) -> Option<Skeleton> {
        let position = match section.get(Key::Position) {
            Some(_) => self.tuple::<3>(section, Key::Position, 0)?.into(),
            None => DVec3::ZERO,
        };
        Some(match leaf {
            LeafName::Line => {
                let (start, end) =
                    (self.needed_tuple(section, Key::Start), self.needed_tuple(section, Key::End));
                Segment { from: start?.into(), to: end?.into() }.into()
            }
            LeafName::Cylinder => {
                let direction = self.direction(section);
                let (radius, height) = (self.length(section, Key::Radius), self.length(section, Key::Height));
                let (direction, radius, height) = (direction?, radius?, height?);
                // A cylinder without height would lose the direction of its axis.
                if height == 0.0 {
                    Disc { center: position, normal: direction, radius }.into()
                } else {
                    Cylinder { from: position, to: position + height * direction, radius }.into()
                }
            }
            LeafName::Disc => {
                let (normal, radius) = (self.direction(section), self.length(section, Key::Radius));
                Disc { center: position, normal: normal?, radius: radius? }.into()
            }
            LeafName::Ring => {
                let (normal, radius) = (self.direction(section), self.length(section, Key::Radius));
                Ring { center: position, normal: normal?, radius: radius? }.into()
            }
            LeafName::Cube => {
                let half = self.length(section, Key::Side)?;
                skeleton::Cuboid { center: position, half: DVec3::splat(half) }.into()
            }
            LeafName::Triangle => {
                let corners = [Key::Corner0, Key::Corner1, Key::Corner2]
                    .map(|key| self.needed_tuple::<3>(section, key).map(DVec3::from));
                Triangle { a: corners[0]?, b: corners[1]?, c: corners[2]? }.into()
            }
            LeafName::Point | LeafName::Null | LeafName::Instance | LeafName::QuadricPoint => {
                Point { at: position }.into()
            }
        })
    }

    /// A direction of length 1.
    fn direction(&mut self, section: &Section) -> Option<DVec3> {
        let direction: DVec3 = self.needed_tuple::<3>(section, Key::Direction)?.into();
        let unit = direction.try_normalize();
        if unit.is_none() {
            let span = section.get(Key::Direction);
            self.errors.add(|| Diagnostic::error(span, "the direction is zero"));
        }
        unit
    }
}
