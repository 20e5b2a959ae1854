//! A group of sums: what is measured together because the same settings touch it.

use std::any::Any;
use std::borrow::Cow;
use std::fmt::{Debug, Display};
use std::future::Future;

use serde_json::{Value, json};
use xxhash_rust::xxh3::Xxh3Default;

use crate::accumulate::{ComputedBy, Decoder, Encoder, Sums};
use crate::compute::{Pending, Session};
use crate::error::Result;
use crate::estimate::Analysis;
use crate::plan::{Batch, DeviceCosts, EnsembleShape};
use crate::points::{Domain, Ensemble};
use crate::request::{Lists, Request, Statistic};
use crate::samplers::Process;

/// What is asked for, of what points.
#[derive(Clone, Copy)]
pub(crate) struct Ask<'a> {
    pub(crate) request: &'a Request,
    /// The files of numbers that the request names.
    pub(crate) lists: &'a Lists,
    pub(crate) domain: &'a Domain,
    /// Number and size of all realizations, those of other shards too.
    pub(crate) shape: EnsembleShape,
    /// The names of the classes of points.
    pub(crate) classes: &'a [String],
}

impl Ask<'_> {
    pub(crate) fn wants(&self, statistic: Statistic) -> bool {
        self.request.stats.contains(&statistic)
    }
}

/// What estimates are made for, besides the sums.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub(crate) request: &'a Request,
    pub(crate) domain: &'a Domain,
    /// Where the points come from, if that has closed forms.
    pub(crate) process: Option<&'a Process>,
    /// Of the realizations that were measured.
    pub(crate) shape: EnsembleShape,
}

impl Subject<'_> {
    /// The process whose closed forms hold here: of points that are not weighted, at the centres of our own bins and rings, on a cubic torus.
    pub(crate) fn closed_forms(&self) -> Option<&Process> {
        let foreign = self.request.conventions().foreign;
        let uniform = !self.request.input.is_inhomogeneous();
        self.process.filter(|_| !foreign && uniform && self.domain.is_cubic())
    }
}

/// How much was computed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Effort {
    /// Unordered pairs, looked at or not.
    pub(crate) pairs: f64,
    /// Points times stored wave vectors.
    pub(crate) products: f64,
}

/// The plan of a group of sums, which says all there is to say of them: how they are measured, which of them are of the same
/// thing, what is read off them. One type per group; a room has one or more.
pub(crate) trait Group: Clone + PartialEq + Debug + Display + Send + Sync + 'static {
    /// What is added up.
    type Sums: Sums;

    /// Its name where progress is told, and in files.
    const NAME: &'static str;

    /// The name of its stage, in timings.
    const STAGE: &'static str;

    /// Whether one leaf of realizations is one product: none can be added to it.
    const WHOLE_LEAVES: bool = false;

    /// Whether its warnings come after those of groups without this.
    const LAST_WORDS: bool = false;

    /// The statistics of `stats` that it gives.
    fn statistics(&self) -> Vec<Statistic>;

    /// All that the sums depend on besides the points and the domain: sums with equal ones are of the same thing and may be
    /// added. The number of realizations is no part of it.
    fn identity(&self) -> Value;

    /// Realizations worked on at a time.
    fn batch(&self) -> Batch;

    /// Takes what suits a device.
    fn suit(&mut self, _: &DeviceCosts) {}

    /// Sums of no realization yet: others are of this plan's form if they can be added to these.
    fn none(&self, by: ComputedBy) -> Self::Sums;

    /// The sums of a batch.
    fn measure(&self, batch: &Ensemble, session: &mut Session<'_>) -> impl Future<Output = Result<Self::Sums>>;

    /// Adds to what was found.
    fn estimate(&self, sums: &Self::Sums, subject: &Subject<'_>, found: &mut Analysis);

    /// What the user should know of what was found.
    fn warnings(&self, _: &Self::Sums, _: &Subject<'_>, _: &Parts, _: &Analysis) -> Vec<String> {
        Vec::new()
    }

    /// What is computed for a realization of `n` points.
    fn effort(&self, _n: u64) -> Effort {
        Effort::default()
    }

    /// What that takes, in seconds of one thread (a GPU as a whole counts as one), by the plan's costs.
    fn seconds(&self, _n: f64) -> f64 {
        0.0
    }

    /// Bytes that its sums, estimates and output take at most, beside the points of a batch; 0 where that is little.
    fn memory(&self) -> u128 {
        0
    }

    /// How a simulation for envelopes measures it; `None` if no curve depends on it.
    fn in_simulations(&self) -> Option<Self> {
        None
    }

    /// Values of the curves that envelopes are made of.
    fn curve_values(&self) -> usize {
        0
    }

    /// Prepares for other settings while the measurement goes on.
    fn keep_ready(&mut self) {}

    /// Sums of this plan as sums of another, if they hold those: with the plan by which they go on, and whether they were
    /// binned anew. `sizes` are the numbers of points of the realizations.
    fn kept(&self, sums: &Self::Sums, wanted: &Self, _sizes: &mut dyn Iterator<Item = u64>) -> Option<Kept<Self>> {
        let same = self.identity() == wanted.identity();
        same.then(|| Kept { plan: wanted.clone(), sums: sums.clone(), rebinned: false })
    }

    /// The name of a group whose sums over all realizations must be there first.
    fn waits_for(&self) -> Option<&'static str> {
        None
    }

    /// The same plan, now that those sums are there.
    fn after(&self, _: &dyn PartSums, _: &dyn Part, _: &Request) -> Result<Self> {
        Ok(self.clone())
    }
}

/// Sums kept for other settings.
pub(crate) struct Kept<G: Group> {
    pub(crate) plan: G,
    pub(crate) sums: G::Sums,
    pub(crate) rebinned: bool,
}

/// Any `Group`.
pub(crate) trait Part: Any + Debug + Display + Send + Sync {
    fn name(&self) -> &'static str;
    fn stage(&self) -> &'static str;
    fn whole_leaves(&self) -> bool;
    fn last_words(&self) -> bool;
    fn statistics(&self) -> Vec<Statistic>;
    fn identity(&self) -> Value;
    fn batch(&self) -> Batch;
    fn suit(&mut self, device: &DeviceCosts);
    fn measure<'a>(&'a self, batch: &'a Ensemble, session: &'a mut Session<'_>) -> Pending<'a, Box<dyn PartSums>>;
    fn estimate(&self, sums: &dyn PartSums, subject: &Subject<'_>, found: &mut Analysis);
    fn warnings(&self, sums: &dyn PartSums, subject: &Subject<'_>, parts: &Parts, found: &Analysis) -> Vec<String>;
    fn effort(&self, n: u64) -> Effort;
    fn seconds(&self, n: f64) -> f64;
    fn memory(&self) -> u128;
    fn in_simulations(&self) -> Option<Box<dyn Part>>;
    fn curve_values(&self) -> usize;
    fn keep_ready(&mut self);
    fn kept(&self, sums: &dyn PartSums, wanted: &dyn Part, sizes: &mut dyn Iterator<Item = u64>) -> Option<KeptPart>;
    fn waits_for(&self) -> Option<&'static str>;
    fn after(&self, sums: &dyn PartSums, of: &dyn Part, request: &Request) -> Result<Box<dyn Part>>;
    fn decode(&self, from: &mut Decoder<'_>) -> Result<Box<dyn PartSums>>;
    fn clone_part(&self) -> Box<dyn Part>;
    fn equals(&self, other: &dyn Part) -> bool;
}

/// Sums kept for other settings, of any group.
pub(crate) struct KeptPart {
    pub(crate) part: Box<dyn Part>,
    pub(crate) sums: Box<dyn PartSums>,
    pub(crate) rebinned: bool,
}

impl<G: Group> Part for G {
    fn name(&self) -> &'static str {
        G::NAME
    }

    fn stage(&self) -> &'static str {
        G::STAGE
    }

    fn whole_leaves(&self) -> bool {
        G::WHOLE_LEAVES
    }

    fn last_words(&self) -> bool {
        G::LAST_WORDS
    }

    fn statistics(&self) -> Vec<Statistic> {
        Group::statistics(self)
    }

    fn identity(&self) -> Value {
        Group::identity(self)
    }

    fn batch(&self) -> Batch {
        Group::batch(self)
    }

    fn suit(&mut self, device: &DeviceCosts) {
        Group::suit(self, device);
    }

    fn measure<'a>(&'a self, batch: &'a Ensemble, session: &'a mut Session<'_>) -> Pending<'a, Box<dyn PartSums>> {
        Box::pin(async { Ok(Box::new(Group::measure(self, batch, session).await?) as Box<dyn PartSums>) })
    }

    fn estimate(&self, sums: &dyn PartSums, subject: &Subject<'_>, found: &mut Analysis) {
        if let Some(sums) = of(sums) {
            Group::estimate(self, sums, subject, found);
        }
    }

    fn warnings(&self, sums: &dyn PartSums, subject: &Subject<'_>, parts: &Parts, found: &Analysis) -> Vec<String> {
        of(sums).map_or(Vec::new(), |sums| Group::warnings(self, sums, subject, parts, found))
    }

    fn effort(&self, n: u64) -> Effort {
        Group::effort(self, n)
    }

    fn seconds(&self, n: f64) -> f64 {
        Group::seconds(self, n)
    }

    fn memory(&self) -> u128 {
        Group::memory(self)
    }

    fn in_simulations(&self) -> Option<Box<dyn Part>> {
        Group::in_simulations(self).map(|part| Box::new(part) as Box<dyn Part>)
    }

    fn curve_values(&self) -> usize {
        Group::curve_values(self)
    }

    fn keep_ready(&mut self) {
        Group::keep_ready(self);
    }

    fn kept(&self, sums: &dyn PartSums, wanted: &dyn Part, sizes: &mut dyn Iterator<Item = u64>) -> Option<KeptPart> {
        let wanted = (wanted as &dyn Any).downcast_ref::<G>()?;
        let Kept { plan, sums, rebinned } = Group::kept(self, of(sums)?, wanted, sizes)?;
        Some(KeptPart { part: Box::new(plan), sums: Box::new(sums), rebinned })
    }

    fn waits_for(&self) -> Option<&'static str> {
        Group::waits_for(self)
    }

    fn after(&self, sums: &dyn PartSums, of: &dyn Part, request: &Request) -> Result<Box<dyn Part>> {
        Ok(Box::new(Group::after(self, sums, of, request)?))
    }

    fn decode(&self, from: &mut Decoder<'_>) -> Result<Box<dyn PartSums>> {
        let sums = G::Sums::decode(from)?;
        let none = ComputedBy { backends: Vec::new(), devices: Vec::new() };
        let fits = Sums::merge(&mut self.none(none), sums.clone());
        fits.map_err(|e| from.error(format!("sums of another form than its request asks for: {e}")))?;
        Ok(Box::new(sums))
    }

    fn clone_part(&self) -> Box<dyn Part> {
        Box::new(self.clone())
    }

    fn equals(&self, other: &dyn Part) -> bool {
        (other as &dyn Any).downcast_ref() == Some(self)
    }
}

impl PartialEq for dyn Part {
    fn eq(&self, other: &Self) -> bool {
        self.equals(other)
    }
}

/// Sums of any group.
pub(crate) trait PartSums: Any + Debug + Send + Sync {
    fn merge(&mut self, other: Box<dyn PartSums>) -> Result<()>;
    fn append(&mut self, next: Box<dyn PartSums>) -> Result<()>;
    fn computed_by(&self) -> Option<&ComputedBy>;
    fn encode(&self, out: &mut Encoder);
    fn clone_sums(&self) -> Box<dyn PartSums>;
}

impl<S: Sums> PartSums for S {
    fn merge(&mut self, other: Box<dyn PartSums>) -> Result<()> {
        let other: Box<dyn Any> = other;
        // Sums of one name are of one type.
        other.downcast::<S>().map_or(Ok(()), |other| Sums::merge(self, *other))
    }

    fn append(&mut self, next: Box<dyn PartSums>) -> Result<()> {
        let next: Box<dyn Any> = next;
        next.downcast::<S>().map_or(Ok(()), |next| Sums::append(self, *next))
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        Sums::computed_by(self)
    }

    fn encode(&self, out: &mut Encoder) {
        Sums::encode(self, out);
    }

    fn clone_sums(&self) -> Box<dyn PartSums> {
        Box::new(self.clone())
    }
}

/// Sums as those of a type.
pub(crate) fn of<T: 'static>(sums: &dyn PartSums) -> Option<&T> {
    (sums as &dyn Any).downcast_ref()
}

/// The plans of all groups, in the order in which they are measured.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Parts(Vec<Box<dyn Part>>);

impl Parts {
    pub(crate) fn add(&mut self, group: impl Group) {
        self.0.push(Box::new(group));
    }

    /// Adds one that is measured before all others.
    pub(crate) fn add_first(&mut self, group: impl Group) {
        self.0.insert(0, Box::new(group));
    }

    pub(crate) fn push(&mut self, part: Box<dyn Part>) {
        self.0.push(part);
    }

    /// The plan of one group.
    pub(crate) fn get<G: Group>(&self) -> Option<&G> {
        self.iter().find_map(|part| (part as &dyn Any).downcast_ref())
    }

    /// The same, to change it.
    pub(crate) fn get_mut<G: Group>(&mut self) -> Option<&mut G> {
        self.0.iter_mut().find_map(|part| (part.as_mut() as &mut dyn Any).downcast_mut())
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &dyn Part> {
        self.0.iter().map(Box::as_ref)
    }

    pub(crate) fn iter_mut(&mut self) -> impl Iterator<Item = &mut Box<dyn Part>> {
        self.0.iter_mut()
    }

    /// Whether anything looks at pairs of points.
    pub(crate) fn needs_pairs(&self) -> bool {
        let of_pairs = [Statistic::Pcf, Statistic::KFunction, Statistic::PcfVector, Statistic::Neighbors];
        self.iter().any(|part| part.statistics().iter().any(|s| of_pairs.contains(s)))
    }
}

impl Clone for Parts {
    fn clone(&self) -> Self {
        Self(self.0.iter().map(|part| part.clone_part()).collect())
    }
}

/// Numbers in an identity: themselves where they are few, else their number, ends and digest.
pub(crate) fn digest(values: impl Iterator<Item = f64> + Clone) -> Value {
    const FEW: usize = 64;
    let count = values.clone().count();
    if count <= FEW {
        return values.collect::<Vec<_>>().into();
    }
    let mut hash = Xxh3Default::new();
    values.clone().for_each(|x| hash.update(&x.to_le_bytes()));
    let ends = [values.clone().next(), values.last()];
    json!({ "count": count, "ends": ends, "digest": format!("{:032x}", hash.digest128()) })
}

/// All sums of a track: of whole leaves, with those of the one being filled.
pub(crate) fn together<'a>(
    whole: Option<&'a dyn PartSums>,
    leaf: Option<&'a dyn PartSums>,
) -> Result<Option<Cow<'a, dyn PartSums>>> {
    Ok(match (whole, leaf) {
        (None, None) => None,
        (Some(one), None) | (None, Some(one)) => Some(Cow::Borrowed(one)),
        (Some(whole), Some(leaf)) => {
            let mut all = whole.clone_sums();
            all.merge(leaf.clone_sums())?;
            Some(Cow::Owned(all))
        }
    })
}

impl ToOwned for dyn PartSums {
    type Owned = Box<dyn PartSums>;

    fn to_owned(&self) -> Self::Owned {
        self.clone_sums()
    }
}
