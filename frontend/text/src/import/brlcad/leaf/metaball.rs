//! Metaballs of BRL-CAD: sums of fields around points that do not end.
//!
//! ```text
//! method 1    sum f |f| / r^2 >= threshold                            isopotential
//! method 2    sum exp(b - b r^2 / f^2) >= threshold                   Blinn's
//! ```
//!
//! Some point has to give its share of the threshold at least, which bounds how far the surface may be from
//! it; the field ends at the box of all these balls.

use glam::DVec3;
use jbt_model::bounds::Bounds;
use jbt_model::builder::{Term, x, y, z};
use jbt_model::tree::Tree;

use super::make::{Flaw, SolidLeaf, positive};
use jbt_ir::limits::MAX_SKELETON_POINTS;

/// Numbers of a point in the file: position, field strength, blobbiness.
type MetaballPoint = [f64; 5];

/// A metaball: the sum of the fields of its points, divided so that the threshold is 1/2.
pub(super) fn metaball(method: f64, threshold: f64, points: &[MetaballPoint]) -> Result<SolidLeaf, Flaw> {
    let threshold = positive("threshold", threshold)?;
    if points.is_empty() || points.len() > MAX_SKELETON_POINTS {
        return Err(format!("it has {} points, and 1 to {MAX_SKELETON_POINTS} are read", points.len()));
    }
    let share = threshold / points.len() as f64;
    let scale = 0.5 / threshold;
    let mut bounds = Bounds::EMPTY;
    let mut trees = Vec::with_capacity(points.len());
    for &[px, py, pz, f, b] in points {
        let squared = (x() - px).square() + (y() - py).square() + (z() - pz).square();
        let (field, reach): (Term, f64) = if method == 1.0 {
            // At the point itself the field has a value too.
            (scale * f * f.abs() / squared.max(1e-9 * f * f), f / share.sqrt())
        } else if method == 2.0 {
            let (f, b) = (positive("f", f.abs())?, positive("b", b)?);
            let level = 1.0 - share.ln() / b;
            (((b + scale.ln()) - (b / (f * f)) * squared).exp(), f * level.max(0.0).sqrt())
        } else {
            return Err(format!("its method is {method}, and 1 and 2 are read"));
        };
        if reach > 0.0 {
            let at = DVec3::new(px, py, pz);
            bounds = bounds.hull(Bounds::new(at - reach, at + reach));
        }
        trees.push(Tree::expression(field));
    }
    if bounds.is_empty() {
        return Err("nothing of it reaches its threshold".to_owned());
    }
    let nodes = trees.len() + 2;
    let margin = 0.01 * bounds.longest_side();
    let low = bounds.min.to_array().map(|low| low - margin);
    let high = bounds.max.to_array().map(|high| high + margin);
    let tree = Tree::sum(trees).within(low, high);
    Ok(SolidLeaf { tree, bounds, nodes, has_radius: true })
}
