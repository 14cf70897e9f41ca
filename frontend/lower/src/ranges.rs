//! Makes the range function of a scene, and what there is to know about its tables.

use std::iter::repeat_n;

use jbt_ir::{Entity as _, Function, InstKind, Rule, Store, watch};

use super::emit::{self, TableCode};
use super::instance::{Scene, SpaceId};
use super::prune_info::{PruneInfo, RangeFunction, Support, SupportSpace, TablePruneInfo};
use super::recipe::Member;
use super::rows;
use super::shape::{Hoist, Shapes};
use super::support::Supports;
use super::workers::Workers;
use jbt_model::check::NodeId;
use jbt_model::diagnostic::Diagnostic;

/// The range function of a scene, and what there is to know about its tables.
pub(super) fn ranges(
    scene: &Scene<'_>,
    shapes: &Shapes,
    workers: &dyn Workers,
) -> Result<RangeFunction, Vec<Diagnostic>> {
    let code = emit::emit_ranges(scene, shapes)?;
    let rows = rows::rows(scene, shapes, &code, workers)?;
    let mut supports = Supports::new(scene, workers);
    let mut tables = Store::new();
    let rules = rules(&code.function);
    for ((code, members), rule) in code.tables.iter().zip(&rows.members).zip(rules) {
        tables.push(table_info(scene, &mut supports, (code, rule), members));
    }
    let iso2 = (2.0 * scene.tree.iso()) as f32;
    let info = PruneInfo {
        tables,
        probes: code.function.outputs.len() - 1,
        decisions: code.decisions,
        contests: code.contests,
        iso2,
    };
    Ok(RangeFunction { function: code.function, tables: rows.tables, info })
}

/// By table, what may be done with rows that are zero: nothing where no fold runs them.
fn rules(function: &Function) -> Vec<Rule> {
    let mut rules = vec![Rule::Never; function.tables.len()];
    for data in function.insts.values() {
        if let InstKind::Fold(fold) = &data.kind {
            rules[fold.table.index()] = fold.rule;
        }
    }
    rules
}

fn table_info(
    scene: &Scene<'_>,
    supports: &mut Supports<'_>,
    (code, rule): (&TableCode, Rule),
    members: &[Member],
) -> TablePruneInfo {
    let space = match (code.space, code.probe) {
        (SpaceId(0), _) => SupportSpace::World,
        (_, Some(probe)) => SupportSpace::Probed(probe),
        (_, None) => SupportSpace::Unknown,
    };
    // Supports are copied into a list of their exact length.
    let count: usize = members.iter().map(|member| member.rows(scene)).sum();
    watch::take(count * (size_of::<NodeId>() + size_of::<Support>()));
    let (mut nodes, mut found) = (Vec::with_capacity(members.len()), Vec::with_capacity(members.len()));
    for member in members {
        nodes.extend(repeat_n(member.node(scene), member.rows(scene)));
        match member.run(scene) {
            Some(_) if found.is_empty() => found = supports.take_run(member.field(scene)),
            Some(_) => found.append(&mut supports.take_run(member.field(scene))),
            None => found.push(support(supports, member)),
        }
    }
    TablePruneInfo {
        space,
        supports: found.into(),
        rule,
        nodes,
        is_hoisted: members.iter().any(|member| matches!(member, Member::Hoisted(_))),
    }
}

fn support(supports: &Supports<'_>, member: &Member) -> Support {
    match member {
        Member::Operand { id, .. } | Member::Particle { id, .. } | Member::Hoisted(Hoist::Instance(id)) => {
            supports.of(*id)
        }
        Member::Hoisted(Hoist::Field(field)) => supports.of_field(*field),
        Member::Piece(field, piece) => supports.of_piece(*field, *piece),
        Member::Hoisted(Hoist::Space(_) | Hoist::Computed(_)) => Support::EVERYWHERE,
    }
}
