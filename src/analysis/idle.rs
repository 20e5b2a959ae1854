//! Settings that say nothing about the statistics asked for: refused when typed, left out when a viewer hides a panel.

use super::plan::axes;
use crate::error::{Error, Result, number, numbers};
use crate::plan::Convention;
use crate::request::{Request, Statistic};
use crate::setting::Setting;

use Statistic::{Covariance, KFunction, Neighbors, Pcf, PcfVector, Radial, Spectrum};

const PAIRS: &[Statistic] = &[Pcf, KFunction];
const WAVES: &[Statistic] = &[Spectrum, Radial];

/// A setting that was given.
struct Given {
    setting: Setting,
    value: String,
    /// The statistics it is about.
    of: &'static [Statistic],
    /// Takes it back, with what only says more about it.
    unset: fn(&mut Request),
}

fn given(request: &Request) -> Vec<Given> {
    let lower = |text: String| text.to_lowercase();
    let yes = |on: bool| on.then(|| "(given)".to_string());
    let convention = (request.convention != Convention::Ours).then(|| request.convention.to_string());
    let of_convention = if request.convention == Convention::Psa { &[Pcf, Spectrum, Radial] } else { WAVES };
    type Row = (Setting, Option<String>, &'static [Statistic], fn(&mut Request));
    let settings: [Row; 23] = [
        (Setting::RMax, request.r_max.map(number), PAIRS, |r| r.r_max = None),
        (Setting::Bins, request.bins.map(|b| b.to_string()), PAIRS, |r| r.bins = None),
        (Setting::BinScale, request.bin_scale.map(|s| lower(format!("{s:?}"))), PAIRS, |r| r.bin_scale = None),
        (Setting::Edges, request.edges.as_ref().map(|e| e.display().to_string()), PAIRS, |r| r.edges = None),
        (Setting::BeyondHalf, yes(request.beyond_half), PAIRS, |r| r.beyond_half = false),
        (
            Setting::WeightColumn,
            request.input.weight_column.clone(),
            &[Pcf, KFunction, Spectrum, Radial, Covariance],
            |r| r.input.weight_column = None,
        ),
        (Setting::Kernel, request.kernel.map(|k| lower(format!("{k:?}"))), &[Pcf], |r| {
            (r.kernel, r.bandwidth, r.divisor, r.exact_kernel) = (None, None, None, false)
        }),
        (Setting::ClassColumn, request.input.class_column.clone(), &[Pcf], |r| {
            (r.input.class_column, r.classes) = (None, None)
        }),
        (Setting::Correction, request.correction.map(|c| c.to_string()), &[Pcf, KFunction, PcfVector], |r| {
            r.correction = None
        }),
        (Setting::Envelope, request.envelope.map(|n| n.to_string()), &[Pcf, KFunction, Neighbors], |r| {
            r.envelope = None
        }),
        (Setting::LagBins, request.lag_bins.map(|b| b.to_string()), &[PcfVector], |r| r.lag_bins = None),
        (Setting::LagMax, request.lag_max.map(number), &[PcfVector], |r| r.lag_max = None),
        (Setting::LagRings, request.lag_rings.as_ref().map(|r| numbers(r.iter().copied())), &[PcfVector], |r| {
            r.lag_rings = None
        }),
        (Setting::MaxFrequency, request.max_frequency.as_deref().map(axes), WAVES, |r| r.max_frequency = None),
        (Setting::Frequencies, request.frequencies.as_ref().map(|f| f.display().to_string()), &[Spectrum], |r| {
            r.frequencies = None
        }),
        (Setting::RingDirections, request.ring_directions.map(|n| n.to_string()), &[Radial], |r| {
            r.ring_directions = None
        }),
        (Setting::Sectors, request.sectors.map(|n| n.to_string()), WAVES, |r| r.sectors = None),
        (Setting::CovarianceFrequency, request.covariance_frequency.map(|b| b.to_string()), &[Covariance], |r| {
            r.covariance_frequency = None
        }),
        (Setting::Taper, request.taper.map(|t| t.to_string()), WAVES, |r| r.taper = None),
        (Setting::Tapers, request.tapers.map(|n| n.to_string()), WAVES, |r| r.tapers = None),
        (Setting::Debias, request.debias.map(|d| d.to_string()), WAVES, |r| r.debias = None),
        (Setting::Convention, convention, of_convention, |r| r.convention = Convention::Ours),
        (Setting::BugCompatible, yes(request.bug_compatible), of_convention, |r| r.bug_compatible = false),
    ];
    let given = |(setting, value, of, unset): Row| Some(Given { setting, value: value?, of, unset });
    settings.into_iter().filter_map(given).collect()
}

/// A setting of a statistic that was not asked for would be silently ignored.
pub(super) fn refuse_idle_settings(request: &Request) -> Result<()> {
    if let Some(idle) = given(request).into_iter().find(|s| !s.of.iter().any(|s| request.stats.contains(s))) {
        let names: Vec<_> = idle.of.iter().filter_map(clap::ValueEnum::to_possible_value).collect();
        let names = match names.iter().map(|n| n.get_name()).collect::<Vec<_>>().as_slice() {
            [others @ .., one, last] => [others, &[&format!("{one} or {last}")]].concat().join(", "),
            names => names.join(""),
        };
        return Err(Error::setting(idle.setting, idle.value, format!("needs {names} among `stats`")));
    }
    if let Some(path) = request.frequencies.as_ref().filter(|_| request.stats.contains(&Radial)) {
        let reason = "a list of wave vectors has no rings; expected `stats` spectrum without radial";
        return Err(Error::setting(Setting::Frequencies, path.display(), reason));
    }
    if let Some(sectors) = request.sectors.filter(|_| request.frequencies.is_some()) {
        return Err(Error::setting(
            Setting::Sectors,
            sectors,
            "a list of wave vectors has none; expected no `frequencies`",
        ));
    }
    if let Some(n) = request.ring_directions.filter(|_| request.stats.contains(&Spectrum)) {
        let reason =
            "leaves wave vectors out, which `stats` spectrum asks for; expected `stats` radial without spectrum";
        return Err(Error::setting(Setting::RingDirections, n, reason));
    }
    Ok(())
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
        for idle in given(&only).iter().filter(|s| !s.of.iter().any(|s| only.stats.contains(s))).collect::<Vec<_>>() {
            (idle.unset)(&mut only);
        }
        only
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every setting of the table in as few lines as the exclusions among them allow.
    const LINES: [&str; 5] = [
        "--r-max 0.1 --bins 9 --bin-scale log --beyond-half --kernel gaussian --bandwidth 0.01 --divisor d --exact-kernel \
         --class-column c --classes A,B --correction none --envelope 9 --lag-bins 8 --lag-max 0.1 --lag-rings 0.1 x",
        "--edges e.txt --weight-column w --max-frequency 3 --sectors 4 --covariance-frequency 2 x",
        "--frequencies f.txt --taper sine --tapers 2 --debias none --window 0,1,0,1 x",
        "--ring-directions 5 --convention utk x",
        "--convention psa --bug-compatible x",
    ];

    fn request(line: &str) -> Request {
        Request::parse(line.split_whitespace().map(str::to_string)).unwrap()
    }

    #[test]
    fn only_what_is_asked_for_is_left() {
        let all = [Pcf, PcfVector, KFunction, Spectrum, Radial, Covariance, Neighbors];
        let mut seen = std::collections::BTreeSet::new();
        for line in LINES {
            let whole = request(line);
            seen.extend(given(&whole).iter().map(|s| s.setting));
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
        assert_eq!(seen.len(), 23);
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
