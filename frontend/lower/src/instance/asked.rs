//! Who asks for what, in a scene with selectors.

use super::{InstanceKind, Scene, children};
use crate::demand::{Asked, Demand};

/// What is asked for in a scene with selectors.
pub(super) fn demand(scene: &Scene<'_>) -> Demand {
    let mut demand = Demand {
        instances: vec![Asked::default(); scene.instances.len()],
        fields: vec![Asked::default(); scene.fields.len()],
        spaces: vec![Asked::default(); scene.insides.len() + 1],
        bare: vec![false; scene.instances.len()],
        selects: true,
    };
    demand.bare[scene.root.0 as usize] = true;
    demand.instances[scene.root.0 as usize] = Asked { always: true, now: true };
    // Parents come after their children.
    for index in (0..scene.instances.len()).rev() {
        let asked = demand.instances[index];
        let bare = demand.bare[index];
        let kind = &scene.instances[index].kind;
        match kind {
            InstanceKind::Leaf { field, .. } => demand.fields[field.0 as usize].also(asked),
            InstanceKind::Warp { inside, child, weight, .. } => {
                if let Some(weight) = weight {
                    demand.instances[weight.0 as usize].also(asked);
                }
                demand.spaces[inside.0 as usize].also(asked);
                demand.bare[child.0 as usize] |= bare;
                let always = asked.always || !scene.is_shared(*inside);
                demand.instances[child.0 as usize].also(Asked { always, ..asked });
            }
            InstanceKind::Select { children, chosen } => {
                for child in children {
                    demand.bare[child.0 as usize] |= bare;
                }
                demand.instances[children[*chosen].0 as usize].also(Asked { always: false, ..asked });
            }
            InstanceKind::Reduce { .. }
            | InstanceKind::Difference { .. }
            | InstanceKind::Expression { .. }
            | InstanceKind::Map { .. } => {
                for child in children(kind) {
                    demand.instances[child.0 as usize].also(asked);
                }
            }
        }
    }
    demand
}
