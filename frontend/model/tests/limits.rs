//! Models at their limits, and one step beyond.

use jbt_ir::limits::MAX_PARTICLES;
use jbt_model::builder::particles;
use jbt_model::model::Model;
use jbt_model::particles::NumberArray;
use jbt_model::tree::Tree;

/// Nodes that share one array of positions, so that as many particles as a model may have take few megabytes.
#[test]
fn particles_of_a_model_are_counted() {
    const NODES: usize = 128;
    let positions = NumberArray::from(vec![0.5_f32; 3 * (MAX_PARTICLES / NODES)]);
    let model = |more: &[Tree]| {
        let node = |radius: u32| particles(positions.clone(), f64::from(radius + 1));
        Model::new(Tree::sum((0..NODES as u32).map(node).chain(more.iter().cloned())))
    };
    assert!(model(&[]).check().is_ok());
    let errors = model(&[particles([[0.0; 3]], 1.0)]).check().unwrap_err();
    let expected = format!("the tree has {} particles; it may have {MAX_PARTICLES}", MAX_PARTICLES + 1);
    assert_eq!(errors[0].message, expected);
}
