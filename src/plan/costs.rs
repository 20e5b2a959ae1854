//! What methods cost on a device: built in, or as it was measured on the machine at hand (`bench --calibrate`).

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{PairDevice, SearchCosts, WaveCosts};
use crate::error::{Error, Result};

/// Of one device, all that plans choose by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeviceCosts {
    /// Of pairs.
    pub pairs: PairDevice,
    /// Of a spectrum.
    pub waves: WaveCosts,
}

impl DeviceCosts {
    /// The CPU path, as built in.
    pub const CPU: Self = Self { pairs: PairDevice::CPU, waves: WaveCosts::CPU };
}

/// The parts of something by name, in nanoseconds.
pub type CostParts = BTreeMap<String, f64>;

/// Measured costs of some devices, as a file holds them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Costs {
    /// The program that measured, with its version.
    pub program: String,
    /// The machine, in words.
    pub machine: String,
    /// By the name of a device: `cpu`, of one thread, or what a GPU calls itself.
    pub devices: BTreeMap<String, MeasuredCosts>,
}

/// Of one device, in nanoseconds (`SearchCosts`, `WaveCosts`).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredCosts {
    /// The parts of searches for pairs.
    pub pairs: CostParts,
    /// The parts of ways to a spectrum.
    pub waves: CostParts,
}

/// A part of this many nanoseconds or more is none: a thousand seconds.
const LONGEST: f64 = 1e12;

impl Costs {
    /// From the text of a file. `place` names it in errors.
    ///
    /// # Errors
    /// What is no such text, a part that is missing, unknown or no time.
    pub fn read(place: &str, text: &str) -> Result<Self> {
        let wrong = |reason: String| Error::input(place, reason);
        let costs: Self = serde_json::from_str(text)
            .map_err(|e| wrong(format!("no costs as `pairwave bench --calibrate` writes them: {e}")))?;
        for (device, measured) in &costs.devices {
            for (given, parts) in [
                (&measured.pairs, names(&mut { SearchCosts::CPU }.parts())),
                (&measured.waves, names(&mut { WaveCosts::CPU }.parts())),
            ] {
                if let Some(missing) = parts.iter().find(|part| !given.contains_key(**part)) {
                    return Err(wrong(format!("{device} has no {missing}, in nanoseconds")));
                }
                for (part, value) in given {
                    if !parts.contains(&part.as_str()) {
                        return Err(wrong(format!("{device}: {part} is no part of it; expected {}", parts.join(", "))));
                    }
                    if !(*value > 0.0 && *value < LONGEST) {
                        return Err(wrong(format!("{device}: {part} is {value}; expected nanoseconds, more than 0")));
                    }
                }
            }
        }
        Ok(costs)
    }

    /// Those of a device, or its own where it was not measured.
    pub fn of(&self, device: &str, built_in: DeviceCosts) -> DeviceCosts {
        let Some(measured) = self.devices.get(device) else { return built_in };
        let mut costs = built_in;
        let name = if device == CPU { "the CPU, one thread, as measured here" } else { "this GPU, as measured here" };
        (costs.pairs.costs.device, costs.waves.device) = (name, name);
        for (name, part) in costs.pairs.costs.parts() {
            *part = measured.pairs.get(name).copied().unwrap_or(*part);
        }
        for (name, part) in costs.waves.parts() {
            *part = measured.waves.get(name).copied().unwrap_or(*part);
        }
        costs
    }

    /// What tells them from others.
    pub fn digest(&self) -> String {
        let text = serde_json::to_string(&self.devices).unwrap_or_default();
        format!("{:016x}", xxhash_rust::xxh3::xxh3_64(text.as_bytes()))
    }
}

/// The name of the CPU path in a file of costs.
pub const CPU: &str = "cpu";

fn names(parts: &mut [(&'static str, &mut f64)]) -> Vec<&'static str> {
    parts.iter().map(|(name, _)| *name).collect()
}

impl SearchCosts {
    /// What can be measured of them, by name.
    pub fn parts(&mut self) -> Vec<(&'static str, &mut f64)> {
        let Self { device: _, pair, pair_by_table, row, partner, range, cell, sort, cells_per_point: _, max_reach: _ } =
            self;
        vec![
            ("pair", pair),
            ("pair_by_table", pair_by_table),
            ("row", row),
            ("partner", partner),
            ("range", range),
            ("cell", cell),
            ("sort", sort),
        ]
    }
}

impl WaveCosts {
    /// What can be measured of them, by name; those of a transform where there is one.
    pub fn parts(&mut self) -> Vec<(&'static str, &mut f64)> {
        let Self { device: _, f32, f64, term, nufft } = self;
        let mut parts = vec![
            ("f32_entry", &mut f32.entry),
            ("f32_mode", &mut f32.mode),
            ("f32_panel", &mut f32.panel),
            ("f32_finish", &mut f32.finish),
            ("f32_start", &mut f32.start),
            ("f64_entry", &mut f64.entry),
            ("f64_mode", &mut f64.mode),
            ("f64_panel", &mut f64.panel),
            ("f64_finish", &mut f64.finish),
            ("f64_start", &mut f64.start),
            ("term", term),
        ];
        if let Some(nufft) = nufft {
            parts.extend([
                ("nufft_kernel", &mut nufft.kernel),
                ("nufft_row", &mut nufft.row),
                ("nufft_add", &mut nufft.add),
                ("nufft_cell", &mut nufft.cell),
                ("nufft_far_cell", &mut nufft.far_cell),
                ("nufft_start", &mut nufft.start),
            ]);
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(change: impl Fn(&mut Costs)) -> String {
        let of = |parts: Vec<(&'static str, &mut f64)>| parts.into_iter().map(|(n, v)| (n.into(), *v)).collect();
        let measured = MeasuredCosts { pairs: of({ SearchCosts::CPU }.parts()), waves: of({ WaveCosts::CPU }.parts()) };
        let mut costs = Costs {
            program: "pairwave".into(),
            machine: "here".into(),
            devices: BTreeMap::from([(CPU.to_string(), measured)]),
        };
        change(&mut costs);
        serde_json::to_string(&costs).unwrap()
    }

    fn cpu(costs: &mut Costs) -> &mut MeasuredCosts {
        costs.devices.get_mut(CPU).unwrap()
    }

    #[test]
    fn what_was_measured_is_what_plans_choose_by() {
        let same = Costs::read("costs", &text(|_| ())).unwrap();
        let read = same.of(CPU, DeviceCosts::CPU);
        assert_eq!(SearchCosts { device: "", ..read.pairs.costs }, SearchCosts { device: "", ..SearchCosts::CPU });
        assert_eq!(WaveCosts { device: "", ..read.waves }, WaveCosts { device: "", ..WaveCosts::CPU });
        let other = Costs::read("costs", &text(|costs| _ = cpu(costs).waves.insert("term".into(), 7.0))).unwrap();
        assert_eq!(other.of(CPU, DeviceCosts::CPU).waves.term, 7.0);
        assert_eq!(other.of("a GPU", DeviceCosts::CPU), DeviceCosts::CPU);
        assert_ne!(same.digest(), other.digest());
    }

    #[test]
    fn what_is_no_costs_says_why() {
        let refused = |text: &str| Costs::read("costs", text).unwrap_err().to_string();
        assert!(refused("{}").contains("missing field `program`"), "{}", refused("{}"));
        let missing = text(|costs| _ = cpu(costs).pairs.remove("row"));
        assert_eq!(refused(&missing), "costs: cpu has no row, in nanoseconds");
        let unknown = text(|costs| _ = cpu(costs).pairs.insert("rows".into(), 1.0));
        assert!(refused(&unknown).contains("rows is no part of it; expected pair, "), "{}", refused(&unknown));
        let zero = text(|costs| _ = cpu(costs).waves.insert("term".into(), 0.0));
        assert!(refused(&zero).contains("term is 0; expected nanoseconds"), "{}", refused(&zero));
    }
}
