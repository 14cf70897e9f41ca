//! A scene that is edited at random.

use fastrand::Rng;
use jbt::build::{Edge, blinn, param, point, segment, x};
use jbt::{CheckedTree, Model, Number, Tree};

/// A leaf of the scene that is edited.
#[derive(Clone)]
pub struct Leaf {
    kind: u8,
    at: [f64; 3],
    radius: f64,
    color: [f64; 3],
}

impl Leaf {
    pub fn new(rng: &mut Rng) -> Self {
        Self {
            kind: rng.u8(0..12),
            at: std::array::from_fn(|_| 2.0 * rng.f64() - 1.0),
            radius: 0.15 + 0.4 * rng.f64(),
            color: std::array::from_fn(|_| rng.f64()),
        }
    }

    fn tree(&self) -> Tree {
        let end = [self.at[0] + 0.2, self.at[1] - 0.3, self.at[2] + 0.1];
        let leaf = match self.kind {
            0 => segment(self.at, end, self.radius),
            1 => point(self.at, self.radius).strength(-0.7),
            2 => point(self.at, self.radius).falloff(blinn(2.0, 1.0, Edge::Smooth)),
            // A wall: the field ends without a slope.
            3 => {
                let (low, high) = (self.at, self.at.map(|side| side + 0.3 + self.radius));
                Tree::expression_within(0.8 - 0.2 * x(), low, high)
            }
            _ => point(self.at, self.radius),
        };
        leaf.color(self.color)
    }
}

/// The scene that is edited.
pub struct Edited {
    pub leaves: Vec<Leaf>,
    /// Trees of leaves that are as they were.
    made: Vec<Option<Tree>>,
    pub ball: Option<Tree>,
    operator: u8,
    bulge: f64,
    iso: f64,
    shade: f64,
}

impl Edited {
    pub fn new(rng: &mut Rng, leaves: usize) -> Self {
        let leaves: Vec<Leaf> = (0..leaves).map(|_| Leaf::new(rng)).collect();
        let made = vec![None; leaves.len()];
        Self { leaves, made, ball: None, operator: 0, bulge: 0.5, iso: 0.5, shade: 0.5 }
    }

    /// A leaf that is to be changed.
    fn leaf(&mut self, index: usize) -> &mut Leaf {
        self.made[index] = None;
        &mut self.leaves[index]
    }

    /// The model, which shares with the one before what has not changed.
    pub fn model(&mut self) -> Model {
        let leaves = self.leaves.iter().zip(&mut self.made);
        let leaves: Vec<Tree> =
            leaves.map(|(leaf, made)| made.get_or_insert_with(|| leaf.tree()).clone()).collect();
        let bulge = param("bulge", self.bulge);
        let ball =
            || point((0.3, 0.2, &bulge * 0.5 - 0.2), &bulge).color((1.0, param("shade", self.shade), 0.0));
        let ball = self.ball.get_or_insert_with(ball).clone();
        let leaves = leaves.into_iter().chain([ball]);
        let mut model = Model::new(match self.operator {
            0 => Tree::sum(leaves),
            1 => Tree::blend(3.0, leaves),
            _ => Tree::union(leaves),
        });
        model.iso = Number::from(self.iso);
        model
    }
}

/// What something live is given.
pub enum Given<'a> {
    Parameter(&'static str, f64),
    Model(&'a Model),
    Tree(&'a CheckedTree),
}

/// One edit of a scene, given to what follows it. Returns what that answers, and the model as it is now if it
/// was given as a whole.
pub fn edit<C>(
    rng: &mut Rng,
    scene: &mut Edited,
    give: impl FnOnce(Given<'_>) -> C,
) -> (C, Option<CheckedTree>) {
    let some = rng.usize(0..scene.leaves.len());
    match rng.u8(0..40) {
        0..=9 => {
            let by = if rng.u8(0..8) == 0 { 1.5 } else { 0.1 };
            scene.leaf(some).at.iter_mut().for_each(|x| *x += by * (rng.f64() - 0.5));
        }
        10..=14 => scene.leaf(some).radius *= 0.8 + 0.4 * rng.f64(),
        15..=19 => scene.leaf(some).color = [rng.f64(), rng.f64(), 0.5],
        20..=22 if scene.leaves.len() < 300 => {
            let leaf = Leaf { kind: 9, ..Leaf::new(rng) };
            scene.leaves.insert(some, leaf);
            scene.made.insert(some, None);
        }
        23..=25 if scene.leaves.len() > 10 => drop((scene.leaves.remove(some), scene.made.remove(some))),
        26 => scene.operator = (scene.operator + 1) % 3,
        27 => scene.iso = 0.3 + 0.4 * rng.f64(),
        28 => *scene.leaf(some) = Leaf::new(rng),
        29..=33 => {
            scene.bulge = 0.2 + rng.f64();
            scene.ball = None;
            return (give(Given::Parameter("bulge", scene.bulge)), None);
        }
        34..=37 => {
            scene.shade = rng.f64();
            scene.ball = None;
            return (give(Given::Parameter("shade", scene.shade)), None);
        }
        38 => {}
        _ => {
            for index in (0..scene.leaves.len()).step_by(3) {
                scene.leaf(index).at[1] += 0.02;
            }
        }
    }
    let model = scene.model();
    let tree = model.check().expect("a good model");
    let given = if rng.bool() { Given::Model(&model) } else { Given::Tree(&tree) };
    (give(given), Some(tree))
}

/// Three balls far apart, the last one by a parameter.
pub fn balls(x: f64) -> CheckedTree {
    let ball = |x: f64| point([x, 0.0, 0.0], 1.0).color([1.0, 0.5, 0.0]);
    let last = point((6.0, 0.0, 0.0), param("bulge", 0.6)).color((0.0, param("green", 0.5), 1.0));
    Model::new(ball(0.0) + ball(x) + last).check().expect("a good model")
}

pub fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|number| number.to_bits()).collect()
}
