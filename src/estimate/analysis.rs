//! Everything that was found about a batch of point sets: what it was, how it was measured, and one estimate per statistic.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::fmt::Debug;

use crate::accumulate::ComputedBy;
use crate::plan::{Accuracy, Conventions, Correction, EnsembleShape};
use crate::points::read::Input;
use crate::points::{Domain, Ensemble, UnitName};

/// What one statistic found. Every type will do; what else it should do is in its own file.
pub trait Finding: Any + Debug + Send + Sync {}

impl<T: Any + Debug + Send + Sync> Finding for T {}

/// One estimate of each type, by its type, so that a new statistic is no new field anywhere.
#[derive(Debug, Default)]
pub struct Findings(HashMap<TypeId, Box<dyn Finding>>);

impl Findings {
    /// Adds an estimate; one of its type that was there is replaced.
    pub fn insert<T: Finding>(&mut self, found: T) {
        self.0.insert(TypeId::of::<T>(), Box::new(found));
    }

    /// Adds an estimate, if there is one.
    pub fn add<T: Finding>(&mut self, found: Option<T>) {
        found.into_iter().for_each(|found| self.insert(found));
    }

    /// Takes an estimate out.
    pub fn remove<T: Finding>(&mut self) {
        self.0.remove(&TypeId::of::<T>());
    }

    /// The estimate of a type.
    pub fn get<T: Finding>(&self) -> Option<&T> {
        let found: &dyn Any = self.0.get(&TypeId::of::<T>())?.as_ref();
        found.downcast_ref()
    }

    /// The estimate of a type, to be changed.
    pub fn get_mut<T: Finding>(&mut self) -> Option<&mut T> {
        let found: &mut dyn Any = self.0.get_mut(&TypeId::of::<T>())?.as_mut();
        found.downcast_mut()
    }
}

/// Everything that was found. What each statistic found is asked for by its type, `analysis.get::<KFunction>()`, or by name,
/// `analysis.k_function()`.
#[derive(Debug)]
#[non_exhaustive]
pub struct Analysis {
    /// What was analyzed, in words: `sampler jittered, n 1024, K 20, seed 1` or the input files.
    pub subject: String,
    /// What was read, where it was read from files.
    pub input: Option<Input>,
    /// Settings as (name, value), in a fixed order, for the summary.
    pub parameters: Vec<(String, serde_json::Value)>,
    /// The domain.
    pub domain: Domain,
    /// What its length unit is called, if it has a name.
    pub unit: Option<UnitName>,
    /// Number and size of realizations.
    pub shape: EnsembleShape,
    /// Smallest number of points in a realization.
    pub min_points: u64,
    /// The edge correction of g.
    pub correction: Correction,
    /// Whether the grid of P itself was asked for, not only its rings.
    pub grid_wanted: bool,
    /// Whose rings and labels these are.
    pub conventions: Conventions,
    /// What theory says, where the process has a closed form.
    pub closed_form: ClosedForm,
    /// The accuracy asked for.
    pub accuracy: Accuracy,
    /// Who computed the sums.
    pub computed_by: ComputedBy,
    /// The plans, printed.
    pub plan: String,
    /// Wall time per stage, seconds.
    pub timings: Vec<(&'static str, f64)>,
    /// Points that coincide with an earlier one of their realization.
    pub duplicates: u64,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// The first realization, for pictures.
    pub first: Ensemble,
    /// What each statistic found.
    pub findings: Findings,
}

/// Curves known in closed form, at the abscissae of the estimates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ClosedForm {
    /// The process, for legends.
    pub name: String,
    /// g at the bin centres, in the normalization of the estimate.
    pub g: Option<Vec<f64>>,
    /// Mean of P over each ring.
    pub radial: Option<Vec<f64>>,
}

impl Analysis {
    /// One that has found nothing yet, of realizations of the given shape like the first; everything else is as if nothing had been
    /// asked for.
    pub fn new(subject: impl Into<String>, shape: EnsembleShape, first: Ensemble, computed_by: ComputedBy) -> Self {
        Self {
            subject: subject.into(),
            input: None,
            parameters: Vec::new(),
            domain: first.domain().clone(),
            unit: None,
            shape,
            min_points: shape.max_points,
            correction: Correction::None,
            grid_wanted: false,
            conventions: Conventions::default(),
            closed_form: ClosedForm::default(),
            accuracy: Accuracy::default(),
            computed_by,
            plan: String::new(),
            timings: Vec::new(),
            duplicates: 0,
            warnings: Vec::new(),
            first,
            findings: Findings::default(),
        }
    }

    /// What a statistic found; `None` where it was not measured.
    pub fn get<T: Finding>(&self) -> Option<&T> {
        self.findings.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn findings_are_kept_by_type() {
        let mut findings = Findings::default();
        findings.insert(1u8);
        findings.insert("g");
        findings.insert(2u8);
        assert_eq!((findings.get(), findings.get(), findings.get::<u16>()), (Some(&2u8), Some(&"g"), None));
        *findings.get_mut::<u8>().unwrap() = 3;
        assert_eq!(findings.get::<u8>(), Some(&3));
        findings.remove::<u8>();
        assert_eq!((findings.get::<u8>(), findings.get()), (None, Some(&"g")));
    }
}
