//! Sums that carry their rounding error.

/// The sum of all values, as accurate as the sums of the definition.
pub(super) fn total(values: impl Iterator<Item = f64>) -> f64 {
    let mut sum = Compensated::default();
    values.for_each(|x| sum.add(x));
    sum.sum()
}

/// A sum that carries its rounding error (Neumaier 1974).
#[derive(Clone, Copy, Default)]
pub(super) struct Compensated {
    sum: f64,
    error: f64,
}

impl Compensated {
    pub(super) fn add(&mut self, x: f64) {
        let s = self.sum + x;
        self.error += if self.sum.abs() >= x.abs() { (self.sum - s) + x } else { (x - s) + self.sum };
        self.sum = s;
    }

    pub(super) fn sum(&self) -> f64 {
        self.sum + self.error
    }
}

impl FromIterator<f64> for Compensated {
    fn from_iter<I: IntoIterator<Item = f64>>(values: I) -> Self {
        let mut sum = Self::default();
        values.into_iter().for_each(|x| sum.add(x));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is small beside the sum, or beside what is added to it, is kept.
    #[test]
    fn neither_term_loses_what_the_other_rounds_away() {
        assert_eq!(total([1.0, 1e100, 1.0, -1e100].into_iter()), 2.0);
        assert_eq!(total([1e100, 1.0, -1e100, 1.0].into_iter()), 2.0);
    }
}
