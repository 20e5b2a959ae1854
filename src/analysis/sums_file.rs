//! A measurement as bytes, and the sum of two.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::ranges::Ranges;
use super::sizes::Sizes;
use super::track::{Track, join};
use super::{Measurement, Plan};
use crate::accumulate::{Decoder, Encoder};
use crate::compute::Device;
use crate::error::{Error, Result};
use crate::plan::{Costs, EnsembleShape, WaveList};
use crate::points::{Domain, Ensemble};
use crate::request::{Lists, Request, SETTINGS};
use crate::setting::Setting;
use crate::source::Points;
use crate::statistics::group::Part;

impl Measurement {
    /// What its sums are of: sums with equal identities may be added.
    fn identity(&self) -> Value {
        let groups: Map<String, Value> =
            self.wanted().map(|track| (track.part.name().to_string(), track.part.identity())).collect();
        // Costs choose methods, which differ in the last bits of what they sum.
        let costs = self.plan.lists.costs_read().map(Costs::digest);
        json!({ "points": self.source.identity(), "domain": self.source.domain(), "sums": groups, "costs": costs })
    }

    fn wanted(&self) -> impl Iterator<Item = &Track> {
        self.tracks.iter().filter(|track| track.wanted)
    }

    /// Adds other realizations of the same process, measured by the same plan.
    ///
    /// # Errors
    /// Another process, domain or plan, by the name of what differs; realizations that both hold. Nothing has changed then.
    pub fn merge(&mut self, other: Self) -> Result<()> {
        let refuse = |reason: String| Err(Error::input("merge", reason));
        if let Some(difference) = difference("", &self.identity(), &other.identity()) {
            return refuse(format!("the parts are not of the same measurement: {difference}"));
        }
        for (a, b) in self.wanted().filter_map(|a| Some((a, other.track(a.part.name())?))) {
            if let Some(twice) = a.done.common(&b.done) {
                let (first, last) = (twice.start + 1, twice.end);
                return refuse(format!("both parts hold realizations {first} to {last} of {}", a.part.name()));
            }
            if a.leaf.is_some() && b.leaf.is_some() {
                return refuse(format!(
                    "both parts end within {} realizations that are summed together; cut them at multiples of {}",
                    crate::plan::LEAF,
                    crate::plan::LEAF
                ));
            }
        }
        let common: u64 = other.sizes.runs().map(|(run, _)| self.sizes.count(&run)).sum();
        if common != 0 && common != other.sizes.len() {
            return refuse("the parts have some of their realizations in common".into());
        }
        let mut others = other.tracks;
        for track in self.tracks.iter_mut().filter(|track| track.wanted) {
            let Some(at) = others.iter().position(|t| t.wanted && t.part.name() == track.part.name()) else { continue };
            let next = others.swap_remove(at);
            if let Some(whole) = next.whole {
                join(&mut track.whole, whole)?;
            }
            if let Some(leaf) = next.leaf {
                join(&mut track.leaf, leaf)?;
            }
            track.done.merge(&next.done);
        }
        if common == 0 {
            self.duplicates += other.duplicates;
            other.sizes.runs().for_each(|(run, n)| _ = self.sizes.add(run, n));
        }
        let earlier = |a: &Ensemble, b: &Ensemble| a.first_index() <= b.first_index();
        self.first = match (self.first.take(), other.first) {
            (Some(a), Some(b)) => Some(if earlier(&a, &b) { a } else { b }),
            (a, b) => a.or(b),
        };
        for warning in other.warnings {
            if !self.warnings.contains(&warning) {
                self.warnings.push(warning);
            }
        }
        other.clock.stages.into_iter().for_each(|(stage, seconds)| self.clock.add(stage, seconds));
        if other.source.shape().realizations > self.total() {
            (self.source, self.plan) = (other.source, other.plan);
        }
        self.span = 0..self.total();
        Ok(())
    }

    fn track(&self, name: &str) -> Option<&Track> {
        self.wanted().find(|track| track.part.name() == name)
    }

    /// Takes the points that this was measured on, so that it can go on, on a device, after it was read.
    ///
    /// # Errors
    /// Other points.
    pub fn attach(&mut self, source: Arc<Points>, device: &Device) -> Result<()> {
        let domain = |source: &Points| json!({ "points": source.identity(), "domain": source.domain() });
        if let Some(difference) = difference("", &domain(&self.source), &domain(&source)) {
            return Err(Error::input(source.subject(), format!("other points were measured: {difference}")));
        }
        // It was known at the first time what there is to know about them.
        self.source = source;
        self.plan = self.plan.clone().for_device(device.compute());
        let costs = self.plan.costs_of(device.compute());
        self.tracks.iter_mut().for_each(|track| track.part.suit(&costs));
        Ok(())
    }

    /// All of it as bytes: a documented form with a checksum (docs/sums.md).
    pub fn write(&self) -> Vec<u8> {
        let mut out = Encoder::default();
        let source = &self.source;
        out.value("program", concat!("pairwave ", env!("CARGO_PKG_VERSION")));
        out.value("identity", self.identity());
        out.value("subject", source.subject());
        out.value("classes", source.classes().to_vec());
        out.value("input", json!(source.input()));
        out.value("request", request_values(&self.request));
        if let Some(found) = source.inhomogeneity() {
            out.value("intensity", json!(found));
        }
        let shape = source.shape();
        out.value("shape", json!([shape.realizations, shape.mean_points.to_bits(), shape.max_points]));
        out.value("duplicates", self.duplicates);
        out.value("warnings", self.warnings.clone());
        out.value("timings", self.clock.stages.iter().map(|(s, t)| json!([s, t])).collect::<Vec<_>>());
        let (edges, frequencies) = self.plan.lists.read();
        let mirrored = frequencies.map(|f| f.mirrored);
        let read = self.plan.lists_read();
        let costs = self.plan.lists.costs_read();
        out.value("lists", json!({ "edges": edges.is_some(), "frequencies": mirrored, "read": read, "costs": costs }));
        out.f64s("edges", edges.into_iter().flatten().copied());
        out.f64s("frequencies", frequencies.into_iter().flat_map(|f| f.vectors.as_flattened()).copied());
        out.u64s("sizes", self.sizes.runs().flat_map(|(run, n)| [run.start, run.end, n]));
        if let Some(first) = &self.first {
            out.within("first", |out| write_realization(first, out));
        }
        for track in self.wanted() {
            out.within(track.part.name(), |out| {
                out.u64s("realizations", track.done.iter().flat_map(|range| [range.start, range.end]));
                for (name, sums) in [("whole", &track.whole), ("leaf", &track.leaf)] {
                    out.value(name, sums.is_some());
                    if let Some(sums) = sums {
                        out.within(name, |out| sums.encode(out));
                    }
                }
            });
        }
        out.finish()
    }

    /// Reads what `write` wrote. `place` names it in errors.
    ///
    /// # Errors
    /// What is damaged, cut short or no such file, before anything of it is used; parts that do not fit together.
    pub fn read(place: &str, bytes: &[u8]) -> Result<Self> {
        let mut from = Decoder::new(place, bytes)?;
        let request = read_request(&from)?;
        let identity = from.value("identity")?.clone();
        let domain: Domain =
            serde_json::from_value(identity["domain"].clone()).map_err(|e| from.error(format!("its domain: {e}")))?;
        let [realizations, mean_points, max_points]: [u64; 3] = from.read("shape")?;
        let shape = EnsembleShape { realizations, mean_points: f64::from_bits(mean_points), max_points };
        let lists = read_lists(&from, &domain)?;
        let classes: Vec<String> = from.read("classes")?;
        let plan = Plan::with(&request, &domain, shape, &classes, lists)?;
        // Those of a sampler are made anew.
        let source = match (&request.input.sampler, identity["points"]["sampler"].is_string()) {
            (Some(_), true) => Points::open(&request.input)?,
            _ => {
                let (subject, points) = (from.read("subject")?, identity["points"].clone());
                let intensity = if from.value("intensity").is_ok() { from.read("intensity")? } else { None };
                Points::elsewhere(subject, domain.clone(), shape, classes, points, from.read("input")?, intensity)
            }
        };
        let mut read = Self::new(request, Arc::new(source), plan);
        if let Some(difference) = difference("", &identity, &read.identity()) {
            let reason = format!("its sums are not of what this program would measure for its request: {difference}");
            return Err(from.error(reason));
        }
        read.duplicates = from.count("duplicates")?;
        read.warnings = from.read("warnings")?;
        let timings: Vec<(String, f64)> = from.read("timings")?;
        let known = ["points", "cross-validation", "envelope"];
        for (stage, seconds) in timings {
            let named = known.into_iter().chain(read.plan.parts.iter().map(Part::stage)).find(|name| *name == stage);
            named.into_iter().for_each(|name| read.clock.add(name, seconds));
        }
        for &[start, end, n] in from.u64s("sizes")?.as_chunks::<3>().0 {
            if start >= end || end > read.total() || !read.sizes.add(start..end, n) {
                return Err(from.error(format!("its realizations {start}..{end} of {n} points cannot be")));
            }
        }
        if !read.sizes.is_empty() {
            read.first = Some(from.within("first", |from| read_realization(&domain, from))?);
        }
        for track in &mut read.tracks {
            from.within(track.part.name(), |from| read_track(track, &read.sizes, from))?;
        }
        Ok(read)
    }
}

/// The sums of one group and which realizations they hold.
fn read_track(track: &mut Track, sizes: &Sizes, from: &mut Decoder<'_>) -> Result<()> {
    let mut done = Ranges::default();
    for &[start, end] in from.u64s("realizations")?.as_chunks::<2>().0 {
        let known = start < end && sizes.count(&(start..end)) == end - start;
        if !known || done.iter().any(|r| r.start < end && start < r.end) {
            return Err(from.error(format!("its realizations {start}..{end} of {} cannot be", track.part.name())));
        }
        done.add(start..end);
    }
    track.done = done;
    for (name, sums) in [("whole", &mut track.whole), ("leaf", &mut track.leaf)] {
        if from.read::<bool>(name)? {
            *sums = Some(from.within(name, |from| track.part.decode(from))?);
        }
    }
    Ok(())
}

/// Every setting that is given, as it is typed.
fn request_values(request: &Request) -> Map<String, Value> {
    let text = |path: &std::path::PathBuf| path.to_string_lossy().into_owned();
    let of = |setting: Setting| match setting {
        Setting::Files => json!(request.input.files.iter().map(text).collect::<Vec<_>>()),
        Setting::Params => json!(request.input.params),
        setting => json!(request.value(setting)),
    };
    let given = SETTINGS.iter().filter(|row| row.is_given(request));
    given.map(|row| (row.setting.name().to_string(), of(row.setting))).collect()
}

fn read_request(from: &Decoder<'_>) -> Result<Request> {
    let values: BTreeMap<String, Value> = from.read("request")?;
    let mut request = Request::default();
    for (name, value) in values {
        let strange = || from.error(format!("its request has the setting {name} with the value {value}"));
        let row = SETTINGS.iter().find(|row| row.setting.name() == name).ok_or_else(strange)?;
        match (row.setting, value.as_str()) {
            (Setting::Files, _) => {
                let files: Option<Vec<String>> = serde_json::from_value(value.clone()).ok();
                request.input.files = files.ok_or_else(strange)?.into_iter().map(Into::into).collect();
            }
            (Setting::Params, _) => {
                request.input.params = serde_json::from_value(value.clone()).map_err(|_| strange())?;
            }
            (setting, Some(text)) => request.set(setting, text).map_err(|_| strange())?,
            (_, None) => return Err(strange()),
        }
    }
    Ok(request)
}

fn read_lists(from: &Decoder<'_>, domain: &Domain) -> Result<Lists> {
    let given = from.value("lists")?;
    let edges = given["edges"].as_bool().unwrap_or(false).then(|| from.f64s("edges")).transpose()?;
    let mirrored = given["frequencies"].as_bool();
    let list = |mirrored| -> Result<WaveList> {
        let vectors = from.f64s("frequencies")?.as_chunks::<3>().0.to_vec();
        Ok(WaveList { dim: domain.dim(), vectors, mirrored })
    };
    let said = given["read"].as_str().map(String::from);
    let costs: Option<Costs> =
        serde_json::from_value(given["costs"].clone()).map_err(|e| from.error(format!("its costs: {e}")))?;
    Ok(Lists::given(edges, mirrored.map(list).transpose()?, costs, said))
}

/// The integers and marks of one realization.
fn write_realization(one: &Ensemble, out: &mut Encoder) {
    out.value("index", one.first_index());
    let (dim, points) = (one.domain().dim(), one.points_in(0));
    out.value("points", points);
    out.u64s("fractions", (0..dim).flat_map(|a| one.all_fractions(a)[..points].iter().copied()));
    let own = (0..dim).any(|a| one.all_fractions(a) != one.all_lengths(a)) || !one.domain().is_torus();
    out.value("own_lengths", own);
    if own {
        out.u64s("lengths", (0..dim).flat_map(|a| one.all_lengths(a)[..points].iter().copied()));
    }
    out.value("marks", json!([one.weights(0).is_some(), one.classes(0).is_some()]));
    out.f64s("weights", one.weights(0).into_iter().flatten().copied());
    out.u64s("classes", one.classes(0).into_iter().flatten().map(|&c| u64::from(c)));
}

fn read_realization(domain: &Domain, from: &mut Decoder<'_>) -> Result<Ensemble> {
    let points = from.count("points")? as usize;
    let axes = |name: &str| -> Result<Vec<Vec<u64>>> {
        let values = from.u64s(name)?;
        from.check_len(name, values.len(), points.saturating_mul(domain.dim()))?;
        Ok((0..domain.dim()).map(|a| values[a * points..(a + 1) * points].to_vec()).collect())
    };
    let fractions = axes("fractions")?;
    let lengths = from.read::<bool>("own_lengths")?.then(|| axes("lengths")).transpose()?;
    let [weighted, classed]: [bool; 2] = from.read("marks")?;
    let weights = weighted.then(|| from.f64s_of("weights", points)).transpose()?;
    let classes = classed.then(|| from.u64s("classes")).transpose()?;
    if let Some(classes) = &classes {
        from.check_len("classes", classes.len(), points)?;
    }
    let classes = classes.map(|classes| classes.into_iter().map(|c| c as u32).collect());
    Ok(Ensemble::from_integers(domain.clone(), from.count("index")?, fractions, lengths, weights, classes))
}

/// The first difference between two identities, in words: `g(r), edges: …, against …`.
fn difference(at: &str, a: &Value, b: &Value) -> Option<String> {
    match (a, b) {
        (Value::Object(a_keys), Value::Object(b_keys)) => {
            let keys: std::collections::BTreeSet<_> = a_keys.keys().chain(b_keys.keys()).collect();
            let below = |key: &String| if at.is_empty() { key.clone() } else { format!("{at}, {key}") };
            keys.into_iter().find_map(|key| difference(&below(key), &a[key.as_str()], &b[key.as_str()]))
        }
        (a, b) if a == b => None,
        (a, b) => Some(format!("{at}: {}, against {}", short(a), short(b))),
    }
}

/// A value in an error: not longer than a line.
fn short(value: &Value) -> String {
    const MOST: usize = 80;
    let text = if value.is_null() { "nothing".to_string() } else { value.to_string() };
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::cpu::Cpu;
    use crate::control::Control;

    /// A file whose checksum holds but whose sums are of another form than its request asks for.
    #[test]
    fn sums_that_do_not_fit_their_request_are_refused() {
        let device = Device::new(Box::new(Cpu::new(Some(1)).unwrap()), None).unwrap();
        let measured = |bins, f, lags| {
            let mut request = Request { bins: Some(bins), max_frequency: Some(vec![f]), ..Request::default() };
            request.lag_bins = Some(lags);
            request.covariance_frequency = Some(f);
            request.intensity_grid = Some(lags);
            // Rings come with the spectrum; sums of discrepancies and of counts have one form.
            let alike = ["radial", "discrepancy", "counts"];
            request.stats =
                crate::request::Statistic::ALL.iter().copied().filter(|s| !alike.contains(&s.name())).collect();
            (request.input.sampler, request.input.points) = (Some("random".into()), Some(20));
            let mut measurement = Measurement::of(&request).unwrap();
            while measurement.step(&device, &Control::default()).unwrap() {}
            measurement
        };
        let mut seen = 0;
        for k in 0..measured(8, 3, 6).tracks.len() {
            let (mut honest, forged) = (measured(8, 3, 6), measured(9, 4, 7));
            Measurement::read("honest", &honest.write()).map(drop).unwrap();
            honest.tracks[k].whole = forged.tracks[k].whole.as_ref().map(|sums| sums.clone_sums());
            honest.tracks[k].leaf = forged.tracks[k].leaf.as_ref().map(|sums| sums.clone_sums());
            let error = Measurement::read("forged", &honest.write()).err().unwrap().to_string();
            assert!(error.contains("sums of another form"), "{error}");
            seen += 1;
        }
        assert_eq!(seen, 6);
    }
}
