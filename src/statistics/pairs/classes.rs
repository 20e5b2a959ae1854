//! Two classes of points, and the pairs between them.

use std::fmt;

use serde_json::{Value, json};

use super::counts::{Pairs, identity};
use crate::accumulate::{ComputedBy, CrossCounts, PairCounts};
use crate::compute::Session;
use crate::error::{Error, Result};
use crate::estimate::{Analysis, CrossCorrelation, CrossK};
use crate::plan::{Batch, DeviceCosts, PairPlan};
use crate::points::Ensemble;
use crate::request::{Request, Statistic};
use crate::statistics::classes::TwoClasses;
use crate::statistics::group::{Group, Subject};

/// The two classes whose g or K is wanted.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Classes {
    names: [String; 2],
    numbers: [u32; 2],
    pairs: PairPlan,
    /// Whether g is wanted, not only K.
    pcf: bool,
}

impl Classes {
    /// Of the classes asked for among `names`.
    pub(super) fn new(request: &Request, names: &[String], pairs: &Pairs) -> Result<Self> {
        let TwoClasses { names, numbers } = TwoClasses::among(names, request)?;
        Ok(Self { names, numbers, pairs: pairs.plan.clone(), pcf: pairs.pcf })
    }
}

impl Group for Classes {
    type Sums = CrossCounts;

    const NAME: &'static str = "two classes";
    const STAGE: &'static str = "pair_counts (classes)";

    fn statistics(&self) -> Vec<Statistic> {
        Vec::new()
    }

    fn identity(&self) -> Value {
        json!({ "classes": self.names, "pairs": identity(&self.pairs) })
    }

    fn batch(&self) -> Batch {
        self.pairs.batch
    }

    fn seconds(&self, _: f64) -> f64 {
        self.pairs.seconds()
    }

    fn suit(&mut self, device: &DeviceCosts) {
        self.pairs = self.pairs.clone().for_device(device.pairs);
    }

    fn none(&self, by: ComputedBy) -> CrossCounts {
        let none = || PairCounts::new(by.clone(), &self.pairs);
        CrossCounts { a: none(), b: none(), between: none() }
    }

    /// Counts within each class and within both together, one realization after the other: their differences are the
    /// pairs between them, whatever the backend and the correction.
    async fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> Result<CrossCounts> {
        let [a, b] = self.numbers;
        let sets = [vec![a, b], vec![a], vec![b]].map(|classes| batch.of_classes(&classes));
        let mut sums: Option<CrossCounts> = None;
        for k in 0..batch.realizations() {
            let one = sets.each_ref().map(|set| set.slice(k..k + 1));
            let counts = session.all_pair_counts(&self.pairs, &one).await?;
            let [both, a, b] = counts.as_slice() else { continue };
            let mut between = PairCounts::new(both.computed_by.clone(), &self.pairs);
            between.add_between(&self.pairs, both, a, b);
            let next = CrossCounts { a: a.clone(), b: b.clone(), between };
            match &mut sums {
                Some(sums) => sums.merge(&next)?,
                none => *none = Some(next),
            }
        }
        sums.ok_or_else(|| Error::input("points", "there are no realizations"))
    }

    fn estimate(&self, sums: &CrossCounts, subject: &Subject<'_>, found: &mut Analysis) {
        let normalization = subject.request.normalization;
        if self.pcf {
            found.findings.insert(CrossCorrelation::new(self.names.clone(), &self.pairs, sums, normalization));
        }
        found.findings.add(CrossK::new(self.names.clone(), &self.pairs, sums, normalization));
    }
}

impl fmt::Display for Classes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = &self.names;
        writeln!(
            f,
            "classes {a} and {b}: pairs within each and within both together, their difference lies between them"
        )
    }
}
