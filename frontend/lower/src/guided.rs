//! Makes the guide of a scene: the guide function, and what there is to know about its tables.

use jbt_ir::{Entity as _, Function, InstKind, Rule, Store};

use super::emit::{self, TableCode};
use super::guide::{Guide, Guided, SpaceGuide, Support, TableGuide};
use super::occurrence::{Scene, SpaceId};
use super::rows::{self, Member};
use super::shape::{Hoist, Shapes};
use super::support::Supports;
use jbt_model::diagnostic::Diagnostic;
use jbt_model::query::Query;

/// The guide function of a scene, and what there is to know about its tables.
pub(super) fn guided(scene: &Scene<'_>, shapes: &Shapes) -> Result<Guided, Vec<Diagnostic>> {
    let code = emit::emit_guide(scene, shapes)?;
    let rows = rows::rows(scene, shapes, Query::FIELD, &code)?;
    let supports = Supports::new(scene);
    let mut tables = Store::new();
    let rules = rules(&code.function);
    for ((code, members), rule) in code.tables.iter().zip(&rows.members).zip(rules) {
        tables.push(table_guide(scene, &supports, (code, rule), members));
    }
    let iso2 = (2.0 * scene.tree.iso()) as f32;
    let guide = Guide { tables, probes: code.function.outputs.len() - 1, decisions: code.decisions, iso2 };
    Ok(Guided { function: code.function, tables: rows.tables, guide })
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

fn table_guide(
    scene: &Scene<'_>,
    supports: &Supports<'_>,
    (code, rule): (&TableCode, Rule),
    members: &[Member],
) -> TableGuide {
    let space = match (code.space, code.probe) {
        (SpaceId(0), _) => SpaceGuide::World,
        (_, Some(probe)) => SpaceGuide::Probed(probe),
        (_, None) => SpaceGuide::Unknown,
    };
    TableGuide {
        space,
        supports: members.iter().map(|member| support(supports, member)).collect(),
        rule,
        nodes: members.iter().map(|member| member.node(scene)).collect(),
        is_hoisted: members.iter().any(|member| matches!(member, Member::Hoisted(_))),
    }
}

fn support(supports: &Supports<'_>, member: &Member) -> Support {
    match member {
        Member::Operand(id, _) | Member::Hoisted(Hoist::Occurrence(id)) => supports.of(*id),
        Member::Hoisted(Hoist::Field(field)) => supports.of_field(*field),
        Member::Piece(field, piece) => supports.of_piece(*field, *piece),
        Member::Hoisted(Hoist::Space(_) | Hoist::Computed(_)) => Support::EVERYWHERE,
    }
}
