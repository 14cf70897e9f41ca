//! Parameters of a checked tree: the parts that depend on them, and new values without the text.

use std::sync::Arc;

use jbt_ir::{limits, watch};

use super::arena::{CheckedNode, Lineage, NodeId, Paths, check_instances};
use super::groups::widths;
use super::node::check_node;
use super::numbers::check_number;
use super::tree::CheckedTree;
use super::work::check_work;
use crate::diagnostic::{Diagnostic, Diagnostics, Span};
use crate::kind::NodeKind;
use crate::model::Model;
use crate::number::{Number, NumberFormula, ParameterValues};
use crate::parameter::{Fixture, Parameter, is_name, not_finite, refresh, unknown};
use crate::report::{Report, clip};
use crate::word::normalized;
use crate::written::Written;

/// The kind of a node for these values of parameters.
pub(super) fn evaluate(
    written: &Written,
    values: &ParameterValues,
    iso: f64,
    span: Option<Span>,
) -> Result<NodeKind, Diagnostic> {
    let is_plain = written.dependent_numbers().next().is_none();
    let meant = if is_plain { written.evaluated(iso) } else { written.refreshed(values)?.evaluated(iso) };
    meant.map_err(|fault| Diagnostic { span, ..fault })
}

/// The iso-value for these values of parameters, checked.
pub(super) fn check_iso(report: &mut Report, iso: &Number, values: &ParameterValues) -> f64 {
    let span = iso.formula().and_then(NumberFormula::span);
    let iso = match iso.refreshed(values) {
        Ok(iso) => iso.value(),
        Err(error) => {
            report.add(|| error);
            return f64::NAN;
        }
    };
    check_number(report, span, "the iso-value", iso, 0.0);
    if (0.0..limits::MIN_LENGTH).contains(&iso) {
        let message = format!("the iso-value is {iso:?}");
        report.add(|| {
            Diagnostic::error(span, message)
                .expected(format!("a number of at least {:e}", limits::MIN_LENGTH))
        });
    }
    iso
}

/// Names have to be identifiers and unique, values finite.
pub(super) fn check_names(report: &mut Report, parameters: &[Parameter]) {
    let mut seen = std::collections::HashSet::new();
    for parameter in parameters {
        let (name, span) = (clip(&parameter.name), parameter.span);
        if !is_name(&parameter.name) {
            report.add(|| {
                Diagnostic::error(span, format!("a parameter is called `{name}`"))
                    .expected("expected letters, digits and underscores, beginning with a letter, and no word of expressions")
            });
        }
        if !seen.insert(&parameter.name) {
            report.add(|| Diagnostic::error(span, format!("two parameters are called `{name}`")));
        }
        let plain = parameter.setting.is_some() || !parameter.default.depends_on_parameters();
        if plain && !parameter.value().is_finite() {
            let value = parameter.value();
            report.add(|| {
                Diagnostic::error(span, format!("the parameter `{name}` is {value}"))
                    .expected("expected a finite number")
            });
        }
        check_control(report, parameter);
    }
}

/// Its range and its label have to make sense, and its value is in the range. What a default that depends on
/// other parameters is has been refreshed.
fn check_control(report: &mut Report, parameter: &Parameter) {
    let (name, span) = (clip(&parameter.name), parameter.span);
    if let Some(fault) = parameter.range().and_then(|range| range.fault()) {
        report
            .add(|| Diagnostic::error(span, format!("the range of `{name}` makes no sense")).expected(fault));
    } else if let Some(error) = parameter.out_of_range() {
        report.add(|| error);
    }
    if parameter.label().is_some_and(|label| label.contains(['"', '\n', '\r'])) {
        report.add(|| {
            Diagnostic::error(span, format!("the label of `{name}` has a quote or a line end"))
                .expected("expected words on one line")
        });
    }
}

impl Model {
    /// The same with other values of some parameters. As text it has them in place of their defaults.
    ///
    /// A checked tree takes values without another check of the whole: see
    /// [`CheckedTree::with_parameters`].
    ///
    /// ```
    /// use jbt_model::builder::{param, point};
    /// use jbt_model::model::Model;
    /// let ball = Model::new(point([0, 0, 0], param("size", 1.0)));
    /// let large = ball.with_parameters(&[("size", 3.0)]).unwrap();
    /// assert_eq!(large.check().unwrap().support().high(), [3.0; 3]);
    /// assert!(ball.with_parameters(&[("bulge", 3.0)]).is_err());
    /// ```
    ///
    /// # Errors
    /// A parameter that the model does not have or that no setting reaches, and a value that is not finite.
    pub fn with_parameters(&self, settings: &[(&str, f64)]) -> Result<Self, Diagnostics> {
        let mut parameters = self.all_parameters();
        let mut report = Report::default();
        for &(name, value) in settings {
            let place = parameters.iter().position(|parameter| parameter.name() == name);
            match place.map(|place| &mut parameters[place]) {
                None => report.add(|| unknown(name, &parameters)),
                Some(_) if !value.is_finite() => report.add(|| not_finite(name)),
                Some(Parameter { name, declares: Some((what, place)), .. }) => {
                    report.add(|| declares(name, *what, *place));
                }
                Some(parameter) => parameter.setting = Some(value),
            }
        }
        if report.is_empty() {
            Ok(Self { parameters, ..self.clone() })
        } else {
            Err(Diagnostics::new(report.finish(), self.source.clone()))
        }
    }
}

impl CheckedTree {
    /// The named parameters, in the order of their declarations.
    #[must_use]
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The same tree with other values of some parameters. Evaluators of this tree take it without compiling
    /// (`Evaluator::update`). Parameters that are not named keep their values.
    ///
    /// ```
    /// use jbt_text::{Options, parse};
    /// let text = b"jbt 1 param bulge = 0.6 param all = bulge * 2 point { radius all }";
    /// let tree = parse(text, &Options::default()).unwrap().check().unwrap();
    /// let fat = tree.with_parameters(&[("bulge", 1.5)]).unwrap();
    /// assert_eq!(fat.parameters()[1].value(), 3.0);
    /// assert_eq!(fat.support().high(), [3.0; 3]);
    /// assert_eq!(tree.affected_by("bulge"), [tree.root()]);
    /// assert_eq!(tree.with_parameters(&[("bulge", -1.0)]).unwrap_err()[0].message, "the radius is -2");
    /// ```
    ///
    /// Only numbers that depend on these parameters are evaluated and checked again. Cost: that work, and a
    /// copy of the nodes.
    ///
    /// # Errors
    ///
    /// Unknown parameters, formulas without a value, and numbers that the [check](crate::check) refuses;
    /// located if the tree came from a text. Want of memory.
    pub fn with_parameters(&self, settings: &[(&str, f64)]) -> Result<Self, Diagnostics> {
        watch::guarded(|| {
            watch::take(size_of_val(self.nodes()));
            self.with_settings(settings).map_err(|list| self.diagnostics(list))
        })?
    }

    fn with_settings(&self, settings: &[(&str, f64)]) -> Result<Self, Vec<Diagnostic>> {
        let mut report = Report::default();
        let mut parameters = self.parameters.clone();
        for &(name, value) in settings {
            match self.dependence.names.get(&*normalized(name)) {
                None => report.add(|| unknown(name, &self.parameters)),
                Some(_) if !value.is_finite() => report.add(|| not_finite(name)),
                Some(&index) => parameters[index].setting = Some(value),
            }
        }
        if !report.is_empty() {
            return Err(report.finish());
        }
        let values = refresh(&mut parameters)?;
        let mut moved: Vec<bool> = parameters
            .iter()
            .zip(&self.parameters)
            .map(|(new, old)| new.value().to_bits() != old.value().to_bits())
            .collect();
        for (parameter, _) in parameters.iter().zip(&moved).filter(|(_, moved)| **moved) {
            if let Some((what, place)) = parameter.declares {
                report.add(|| declares(&parameter.name, what, place));
            }
            if let Some(error) = parameter.out_of_range() {
                report.add(|| Diagnostic { span: None, ..error });
            }
        }
        let iso = match &self.dependence.iso {
            Some(iso) => check_iso(&mut report, iso, &values),
            None => self.iso,
        };
        let (nodes, changed) = self.evaluated_again(&mut moved, (iso, &values), &mut report);
        if !report.is_empty() {
            report.sort();
            return Err(report.finish());
        }
        let (attributes, dependence) = (self.attributes.clone(), Arc::clone(&self.dependence));
        let (origin, orientation, source) = (self.origin, self.orientation, self.source.clone());
        let lineage = Some(Lineage { from: Arc::clone(&self.nodes), changed: changed.into() });
        let paths = Paths::new(&nodes);
        Ok(Self {
            iso,
            attributes,
            paths,
            nodes,
            parameters,
            dependence,
            origin,
            orientation,
            source,
            lineage,
        })
    }

    /// The nodes, with those that depend on moved parameters evaluated and checked again; and which they
    /// are.
    fn evaluated_again(
        &self,
        moved: &mut [bool],
        (iso, values): (f64, &ParameterValues),
        report: &mut Report,
    ) -> (Arc<Vec<CheckedNode>>, Vec<NodeId>) {
        let affected = self.dependence.affected(&self.parameters, moved);
        if affected.is_empty() {
            return (Arc::clone(&self.nodes), affected);
        }
        let groups = widths(&self.attributes);
        let mut nodes = self.nodes.to_vec();
        let mut in_pieces = false;
        for &id in &affected {
            let node = &mut nodes[id.0 as usize];
            let written = self.dependence.written(id).expect("affected nodes are kept as written");
            let errors = report.count();
            match evaluate(written, values, iso, node.span) {
                Ok(kind) => {
                    check_node(report, &kind, node.children.len(), node.span, &groups, iso);
                    in_pieces |= is_in_pieces(&kind);
                    node.kind = kind;
                }
                Err(error) => report.add(|| error),
            }
            report.expanded_in(errors, node.label.as_ref());
        }
        // A curve may have more pieces now.
        if in_pieces && report.is_empty() {
            check_instances(report, &nodes, limits::MAX_INSTANCES);
            if report.is_empty() {
                check_work(report, &nodes, iso);
            }
        }
        (Arc::new(nodes), affected)
    }

    /// The nodes that a parameter can change, ascending: directly, through other parameters or through the
    /// iso-value. None for an unknown name.
    #[must_use]
    pub fn affected_by(&self, name: &str) -> Vec<NodeId> {
        let Some(&index) = self.dependence.names.get(name) else { return Vec::new() };
        let mut moved = vec![false; self.parameters.len()];
        moved[index] = true;
        self.dependence.affected(&self.parameters, &mut moved)
    }

    /// What a node was written as, if it can change: a number of it depends on a parameter, or it asks for an
    /// iso-value that does. `None`: no parameter changes the node.
    #[must_use]
    #[inline]
    pub fn dependent(&self, id: NodeId) -> Option<&Written> {
        self.dependence.written(id).map(|written| &**written)
    }

    /// Whether any number depends on a parameter.
    #[must_use]
    pub fn depends_on_parameters(&self) -> bool {
        !self.dependence.nodes.is_empty()
    }
}

/// Whether a node is a leaf whose skeleton has any number of pieces.
pub(super) fn is_in_pieces(kind: &NodeKind) -> bool {
    match kind {
        NodeKind::Primitive(leaf) => leaf.skeleton.kind().pieces().is_some(),
        NodeKind::Particles(_)
        | NodeKind::Combine(_)
        | NodeKind::Expression(_)
        | NodeKind::Select(_)
        | NodeKind::Affine(_)
        | NodeKind::Warp(_)
        | NodeKind::Attribute { .. }
        | NodeKind::Constant { .. } => false,
    }
}

fn declares(name: &str, what: Fixture, place: Span) -> Diagnostic {
    let name = clip(name);
    let (message, help) = match what {
        Fixture::Declaration => (
            format!("`{name}` stands in a declaration, which stays as it was read"),
            "set it before the text is read",
        ),
        Fixture::Expansion => (
            format!("`{name}` decides which nodes there are, and they stay as they were read"),
            "set it before the text is read: `Scene::with_parameters` reads it again, and it is compiled again",
        ),
    };
    Diagnostic::error(Some(place), message).expected(help)
}
