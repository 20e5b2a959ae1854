//! Settings that say nothing about what is asked for: refused when typed, left out when a viewer hides a panel.

use super::settings::{Group, INHOMOGENEOUS, Row, SETTINGS, changed_by};
use super::{ESTIMATE, PointsRequest, Request, Statistic};
use crate::error::{Error, Result};
use crate::setting::Setting;

use Statistic::{Radial, Spectrum};

/// The statistics a setting of this request is about.
fn statistics(row: &Row, request: &Request) -> &'static [Statistic] {
    match row.setting {
        Setting::Convention | Setting::BugCompatible => changed_by(&request.conventions()),
        _ => row.statistics,
    }
}

/// Settings that integration reads too.
const OF_INTEGRATION: [Setting; 3] = [Setting::MaxFrequency, Setting::CovarianceFrequency, Setting::WeightColumn];

/// Whether a setting is refused without its statistics. The normalization always has a value, asked for or not.
fn may_be_idle(row: &Row) -> bool {
    !row.statistics.is_empty() && row.setting != Setting::Normalization
}

/// What is given and may be idle.
fn given(request: &Request) -> impl Iterator<Item = &'static Row> {
    SETTINGS.iter().filter(|row| may_be_idle(row) && row.is_given(request))
}

/// What is given and is about no statistic that is asked for.
fn idle(request: &Request) -> impl Iterator<Item = &'static Row> {
    let integrates = !request.integrand.is_empty();
    let estimates = request.input.inhomogeneous.as_deref() == Some(ESTIMATE)
        && INHOMOGENEOUS.iter().any(|s| request.stats.contains(s));
    given(request)
        .filter(|row| !statistics(row, request).iter().any(|s| request.stats.contains(s)))
        .filter(move |row| !(integrates && OF_INTEGRATION.contains(&row.setting)))
        .filter(move |row| !(estimates && row.setting == Setting::IntensityBandwidth))
}

/// A setting of a statistic that was not asked for would be silently ignored.
pub(crate) fn refuse_idle_settings(request: &Request) -> Result<()> {
    if let Some(idle) = idle(request).next() {
        let names: Vec<_> = statistics(idle, request).iter().map(|s| s.name()).collect();
        let names = match names.as_slice() {
            [others @ .., one, last] => [others, &[&format!("{one} or {last}")]].concat().join(", "),
            names => names.join(""),
        };
        let value = if idle.is_switch() { "(given)".into() } else { request.value(idle.setting) };
        let or = if idle.setting == Setting::IntensityBandwidth { ", or `inhomogeneous` estimate" } else { "" };
        return Err(Error::setting(idle.setting, value, format!("needs {names} among `stats`{or}")));
    }
    let drawn = request.input.sampler.is_some() || request.envelope.is_some() || request.input.files.is_empty();
    if let Some(seed) = request.input.seed.filter(|_| !drawn) {
        let reason = "draws the points of `sampler` NAME and the simulations of `envelope`; point files alone have no use for it";
        return Err(Error::setting(Setting::Seed, seed, reason));
    }
    if let Some(path) = request.frequencies.as_ref().filter(|_| request.stats.contains(&Radial)) {
        let reason = "a list of wave vectors has no rings; expected `stats` spectrum without radial";
        return Err(Error::setting(Setting::Frequencies, path.display(), reason));
    }
    if let Some(sectors) = request.sectors.filter(|_| request.frequencies.is_some()) {
        let reason = "a list of wave vectors has none; expected no `frequencies`";
        return Err(Error::setting(Setting::Sectors, sectors, reason));
    }
    if let Some(n) = request.ring_directions.filter(|_| request.stats.contains(&Spectrum)) {
        let reason =
            "leaves wave vectors out, which `stats` spectrum asks for; expected `stats` radial without spectrum";
        return Err(Error::setting(Setting::RingDirections, n, reason));
    }
    Ok(())
}

/// What the program of a convention has no way to do.
pub(crate) fn refuse_unknown_to_convention(request: &Request) -> Result<()> {
    let conventions = request.conventions();
    if !conventions.foreign {
        return Ok(());
    }
    let changed = changed_by(&conventions);
    let concerned = |row: &Row| row.statistics.iter().any(|s| changed.contains(s) && request.stats.contains(s));
    for row in SETTINGS.iter().filter(|row| concerned(row) && row.is_given(request)) {
        if let Some(why) = row.refused {
            let reason = format!("{why}; leave out {}", row.setting.mention());
            return Err(Error::setting(Setting::Convention, request.convention, reason));
        }
    }
    Ok(())
}

/// Files hold their own points; what shapes a sampler's would be silently ignored. A seed is for simulations too, of which
/// nothing is known here: see `refuse_idle_settings`.
pub(crate) fn refuse_settings_of_samplers(points: &PointsRequest) -> Result<()> {
    let request = Request { input: points.clone(), ..Request::default() };
    let shapes = |row: &&Row| row.for_samplers && row.setting != Setting::Seed && row.is_given(&request);
    match SETTINGS.iter().find(shapes) {
        Some(row) => {
            let reason = "applies to `sampler` NAME only, not to point files";
            Err(Error::setting(row.setting, request.value(row.setting), reason))
        }
        None => Ok(()),
    }
}

impl Request {
    /// The same request of these statistics alone, without the settings that say nothing about them. Rings are left out where
    /// a list of wave vectors is given, which has none, and so are directions per ring where all wave vectors are wanted.
    pub fn only(&self, stats: &[Statistic]) -> Self {
        let mut only = Self { stats: stats.to_vec(), ..self.clone() };
        if only.frequencies.is_some() {
            only.stats.retain(|s| *s != Radial);
            only.sectors = None;
        }
        if stats.contains(&Spectrum) {
            only.ring_directions = None;
        }
        for row in idle(&only).collect::<Vec<_>>() {
            (row.get_mut)(&mut only).unset();
        }
        only
    }

    /// The same request without its integrands, and without what says how they are integrated.
    pub fn without_integrals(&self) -> Self {
        let mut without = self.clone();
        for row in SETTINGS.iter().filter(|row| row.group == Group::Integration) {
            (row.get_mut)(&mut without).unset();
        }
        without
    }
}

#[cfg(test)]
#[cfg(feature = "cli")]
mod tests {
    use super::*;
    use Statistic::{Counts, Covariance, Discrepancy, Intensity, KFunction, Neighbors, Pcf, PcfVector};

    /// Every setting of the table in as few lines as the exclusions among them allow.
    const LINES: [&str; 6] = [
        "--r-max 0.1 --bins 9 --bin-scale log --beyond-half --kernel gaussian --bandwidth 0.01 --divisor d --exact-kernel \
         --class-column c --classes A,B --correction none --envelope 9 --lag-bins 8 --lag-max 0.1 --lag-rings 0.1 x",
        "--edges e.txt --weight-column w --envelope-from s --max-frequency 3 --sectors 4 --covariance-frequency 2 \
         --intensity-bandwidth 0.1 --intensity-grid 16 x",
        "--frequencies f.txt --taper sine --tapers 2 --debias none --window 0,1,0,1 x",
        "--intensity-column l x",
        "--inhomogeneous estimate --intensity-bandwidth 0.1 --ring-directions 5 --convention utk x",
        "--convention psa --bug-compatible x",
    ];

    fn request(line: &str) -> Request {
        Request::parse(line.split_whitespace().map(str::to_string)).unwrap()
    }

    #[test]
    fn only_what_is_asked_for_is_left() {
        let all = [Pcf, PcfVector, KFunction, Spectrum, Radial, Covariance, Neighbors, Discrepancy, Counts, Intensity];
        let mut seen = std::collections::BTreeSet::new();
        for line in LINES {
            let whole = request(line);
            seen.extend(given(&whole).map(|row| row.setting));
            // Every subset of the statistics.
            for subset in 0..1 << all.len() {
                let stats: Vec<_> = (0..all.len()).filter(|k| subset >> k & 1 == 1).map(|k| all[k]).collect();
                let only = whole.only(&stats);
                assert!(refuse_idle_settings(&only).is_ok(), "{line} {stats:?}: {:?}", refuse_idle_settings(&only));
                // It can be typed unless nothing is left to measure, and asks for nothing that was not there.
                if !only.stats.is_empty() {
                    assert_eq!(Request::parse(only.arguments()).unwrap(), only, "{line} {stats:?}");
                }
                let typed = whole.arguments();
                let added =
                    only.arguments().into_iter().find(|a| a.starts_with("--") && a != "--stats" && !typed.contains(a));
                assert_eq!(added, None, "{line} {stats:?}");
            }
        }
        let all = SETTINGS.iter().filter(|row| may_be_idle(row)).map(|row| row.setting);
        assert_eq!(seen, all.collect(), "every setting that may be idle is in a line");
    }

    #[test]
    fn nothing_is_left_of_integrals() {
        let whole = request("--integrand disk --estimator ratio --shifts 3 --intensity ramp --by removal --bins 9 x");
        assert_eq!(whole.without_integrals(), request("--bins 9 x"));
    }

    #[test]
    fn what_is_about_a_statistic_stays_with_it() {
        let whole = request(LINES[0]);
        let pcf = whole.only(&[Pcf]);
        assert_eq!((pcf.bins, pcf.kernel, &pcf.classes), (whole.bins, whole.kernel, &whole.classes));
        assert_eq!((pcf.lag_bins, pcf.lag_rings.is_some()), (None, false));
        let vector = whole.only(&[PcfVector]);
        assert_eq!((vector.bins, vector.kernel, vector.bandwidth, vector.lag_bins), (None, None, None, Some(8)));
    }
}
