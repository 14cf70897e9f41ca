//! Arrays of numbers that many owners share: what particles are made of.

use std::fmt;
use std::sync::Arc;

use crate::number::Number;

/// Any number of numbers, in f32 or f64, which clones share. Two are equal if their numbers are, whatever
/// they are kept in.
///
/// It converts from vectors and slices of numbers, and from those of places in space, whose coordinates
/// follow each other: `x y z x y z ..`. A vector, or an [`Arc`] of one, is taken as it is; a slice is copied.
#[derive(Clone)]
pub enum NumberArray {
    /// In f32.
    Single(Arc<Vec<f32>>),
    /// In f64.
    Double(Arc<Vec<f64>>),
}

impl NumberArray {
    /// How many numbers there are.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Single(numbers) => numbers.len(),
            Self::Double(numbers) => numbers.len(),
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A number. Panics if there are not as many.
    #[must_use]
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::Single(numbers) => f64::from(numbers[index]),
            Self::Double(numbers) => numbers[index],
        }
    }

    /// The three numbers of a place in space, by its number. Panics if there are not as many.
    #[must_use]
    #[inline]
    pub fn triple(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Single(numbers) => {
                let [x, y, z] = numbers[3 * index..][..3] else { unreachable!("it has three numbers") };
                [x, y, z].map(f64::from)
            }
            Self::Double(numbers) => {
                let [x, y, z] = numbers[3 * index..][..3] else { unreachable!("it has three numbers") };
                [x, y, z]
            }
        }
    }

    /// All numbers.
    pub fn iter(&self) -> impl Iterator<Item = f64> {
        (0..self.len()).map(|index| self.at(index))
    }

    /// The numbers of some elements of `width` numbers each, one element after the other. Panics if there
    /// are not as many.
    #[must_use]
    pub fn picked(&self, elements: &[usize], width: usize) -> Self {
        let range = |&element: &usize| width * element..width * (element + 1);
        match self {
            Self::Single(numbers) => {
                elements.iter().flat_map(|it| &numbers[range(it)]).copied().collect::<Vec<f32>>().into()
            }
            Self::Double(numbers) => {
                elements.iter().flat_map(|it| &numbers[range(it)]).copied().collect::<Vec<f64>>().into()
            }
        }
    }
}

impl PartialEq for NumberArray {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Single(a), Self::Single(b)) => Arc::ptr_eq(a, b) || a == b,
            (Self::Double(a), Self::Double(b)) => Arc::ptr_eq(a, b) || a == b,
            (Self::Single(single), Self::Double(double)) | (Self::Double(double), Self::Single(single)) => {
                single.len() == double.len() && single.iter().zip(&**double).all(|(a, b)| f64::from(*a) == *b)
            }
        }
    }
}

impl fmt::Debug for NumberArray {
    /// How many there are, and the first ones.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 12;
        write!(f, "{} numbers ", self.len())?;
        let mut list = f.debug_list();
        list.entries(self.iter().take(SHOWN));
        if self.len() > SHOWN { list.finish_non_exhaustive() } else { list.finish() }
    }
}

macro_rules! from_numbers {
    ($($number:ty, $variant:ident);+ $(;)?) => { $(
        impl From<Vec<$number>> for NumberArray {
            fn from(numbers: Vec<$number>) -> Self {
                Self::$variant(Arc::new(numbers))
            }
        }

        impl From<Arc<Vec<$number>>> for NumberArray {
            fn from(numbers: Arc<Vec<$number>>) -> Self {
                Self::$variant(numbers)
            }
        }

        impl From<&[$number]> for NumberArray {
            fn from(numbers: &[$number]) -> Self {
                numbers.to_vec().into()
            }
        }

        impl From<Vec<[$number; 3]>> for NumberArray {
            fn from(places: Vec<[$number; 3]>) -> Self {
                places.into_flattened().into()
            }
        }

        impl From<&[[$number; 3]]> for NumberArray {
            fn from(places: &[[$number; 3]]) -> Self {
                places.as_flattened().into()
            }
        }

        impl<const N: usize> From<[[$number; 3]; N]> for NumberArray {
            fn from(places: [[$number; 3]; N]) -> Self {
                places.as_flattened().into()
            }
        }

        impl<const N: usize> From<[$number; N]> for NumberArray {
            fn from(numbers: [$number; N]) -> Self {
                numbers.to_vec().into()
            }
        }
    )+ };
}

from_numbers! {
    f32, Single;
    f64, Double;
}

/// A number of a particle: one for all of them, or one for each.
///
/// It converts from whatever a [`Number`] converts from, and from whatever an array does.
#[derive(Clone, Debug)]
pub enum PerParticle<T> {
    /// The same for all.
    All(T),
    /// One for each.
    Each(NumberArray),
}

impl<T: PartialEq + From<f64>> PartialEq for PerParticle<T> {
    /// A list of one number is that number.
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::All(a), Self::All(b)) => a == b,
            (Self::Each(a), Self::Each(b)) => a == b,
            (Self::All(one), Self::Each(each)) | (Self::Each(each), Self::All(one)) => {
                each.len() == 1 && T::from(each.at(0)) == *one
            }
        }
    }
}

impl PerParticle<f64> {
    /// That of a particle. Panics if there are not as many.
    #[must_use]
    #[inline]
    pub fn at(&self, index: usize) -> f64 {
        match self {
            Self::All(number) => *number,
            Self::Each(numbers) => numbers.at(index),
        }
    }
}

impl PerParticle<Number> {
    /// The present value.
    #[must_use]
    pub fn value(&self) -> PerParticle<f64> {
        match self {
            Self::All(number) => PerParticle::All(number.value()),
            Self::Each(numbers) => PerParticle::Each(numbers.clone()),
        }
    }

    /// The number of all of them, if it is one.
    #[must_use]
    pub fn all(&self) -> Option<&Number> {
        match self {
            Self::All(number) => Some(number),
            Self::Each(_) => None,
        }
    }

    /// Those of some particles.
    pub(crate) fn picked(&self, particles: &[usize]) -> Self {
        match self {
            Self::All(number) => Self::All(number.clone()),
            Self::Each(numbers) => Self::Each(numbers.picked(particles, 1)),
        }
    }
}

impl From<PerParticle<f64>> for PerParticle<Number> {
    fn from(numbers: PerParticle<f64>) -> Self {
        match numbers {
            PerParticle::All(number) => Self::All(number.into()),
            PerParticle::Each(numbers) => Self::Each(numbers),
        }
    }
}

macro_rules! from_one {
    ($($number:ty),+) => { $(
        impl From<$number> for PerParticle<Number> {
            fn from(number: $number) -> Self {
                Self::All(number.into())
            }
        }
    )+ };
}

macro_rules! from_each {
    ($($numbers:ty),+) => { $(
        impl From<$numbers> for PerParticle<Number> {
            fn from(numbers: $numbers) -> Self {
                Self::Each(numbers.into())
            }
        }
    )+ };
}

from_one! { Number, &Number, f64, f32, i32 }
from_each! { NumberArray, Vec<f32>, Vec<f64>, &[f32], &[f64], Arc<Vec<f32>>, Arc<Vec<f64>> }

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_equal_whatever_they_are_kept_in() {
        let single = NumberArray::from(vec![0.5_f32, 0.25]);
        assert_eq!(single, NumberArray::from([0.5_f64, 0.25]));
        assert_ne!(single, NumberArray::from([0.5_f64]));
        assert_ne!(NumberArray::from([0.1_f32]), NumberArray::from([0.1_f64]));
        assert_eq!(format!("{single:?}"), "2 numbers [0.5, 0.25]");
    }

    #[test]
    fn a_vector_is_taken_as_it_is() {
        let places = vec![[1.0_f32, 2.0, 3.0], [4.0, 5.0, 6.0]];
        let first = places.as_ptr().cast::<f32>();
        let NumberArray::Single(numbers) = NumberArray::from(places) else { panic!("it was f32") };
        assert_eq!(numbers.as_ptr(), first);
        assert_eq!(NumberArray::Single(numbers).triple(1), [4.0, 5.0, 6.0]);
    }

    #[test]
    fn elements_are_picked() {
        let numbers = NumberArray::from([0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(numbers.picked(&[2, 0], 2), NumberArray::from([4.0, 5.0, 0.0, 1.0]));
    }
}
