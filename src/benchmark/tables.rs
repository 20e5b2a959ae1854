//! The tables of a benchmark.

use std::fmt::Write as _;

use super::{Benchmark, Calibration, Explained, Grown, Scene, Way};
use crate::report::some_columns;
use crate::statistics::Table;

/// `bench.csv`: a row per way.
fn ways(all: &Benchmark) -> Table {
    of(all, &all.scenes.iter().collect::<Vec<_>>())
}

fn of(all: &Benchmark, scenes: &[&Scene]) -> Table {
    let rows: Vec<(&Scene, &Way)> = scenes.iter().flat_map(|s| s.ways.iter().map(move |w| (*s, w))).collect();
    let yes = |is: bool| if is { "yes" } else { "" }.to_string();
    Table::new()
        .text("section", rows.iter().map(|(s, _)| s.section.name().into()))
        .text("scene", rows.iter().map(|(s, _)| s.name.clone()))
        .text("method", rows.iter().map(|(_, w)| w.method.clone()))
        .text("device", rows.iter().map(|(_, w)| w.device.clone()))
        .floats("seconds", rows.iter().map(|(_, w)| w.seconds.median))
        .floats("seconds_least", rows.iter().map(|(_, w)| w.seconds.least))
        .floats("seconds_most", rows.iter().map(|(_, w)| w.seconds.most))
        .integers("runs", rows.iter().map(|(_, w)| w.seconds.runs as u64))
        .optional("work", rows.iter().map(|(_, w)| Some(1e9 * w.work?.0)))
        .text("work_of", rows.iter().map(|(_, w)| w.work.map_or(String::new(), |(_, unit)| unit.into())))
        .optional("giga_per_s", rows.iter().map(|(_, w)| Some(w.work?.0 / w.seconds.median)))
        .optional("fma_share", rows.iter().map(|(_, w)| w.share(&all.machine)))
        .optional("error_rms", rows.iter().map(|(_, w)| Some(w.error?[0])))
        .optional("error_max", rows.iter().map(|(_, w)| Some(w.error?[1])))
        .text("error_of", rows.iter().map(|(s, _)| s.error_of.into()))
        .floats("error_statistical", rows.iter().map(|(s, w)| w.statistical.unwrap_or(s.statistical)))
        .optional("k_as_accurate", rows.iter().map(|(s, w)| s.realizations_as_accurate(w)))
        .text("pareto", rows.iter().map(|(_, w)| yes(w.front)))
}

/// `efficiency.csv`: a row per sampler, integrand and number of points.
fn efficiency(all: &Benchmark) -> Table {
    let rows = &all.efficiency;
    Table::new()
        .text("sampler", rows.iter().map(|e| e.sampler.clone()))
        .text("integrand", rows.iter().map(|e| e.integrand.clone()))
        .integers("n", rows.iter().map(|e| e.n))
        .integers("k", rows.iter().map(|e| e.k))
        .floats("seconds_drawing", rows.iter().map(|e| e.drawing.median))
        .floats("seconds_evaluating", rows.iter().map(|e| e.evaluating.median))
        .floats("seconds", rows.iter().map(|e| e.seconds(1.0)))
        .floats("error_rms", rows.iter().map(|e| e.error))
        .floats("error_rms_se", rows.iter().map(|e| e.error_se))
        // How many times as fast as random points to the same error.
        .optional("efficiency", rows.iter().map(|e| Some(all.against_random(e)?[0])))
        .optional("efficiency_se", rows.iter().map(|e| Some(all.against_random(e)?[1])))
}

/// `growth.csv`: a row per size of a problem.
fn growth(all: &Benchmark, rows: &[Grown]) -> Table {
    let pace = all.pace().unwrap_or(1.0);
    Table::new()
        .text("of", rows.iter().map(|g| g.of.into()))
        .text("variable", rows.iter().map(|g| g.variable.into()))
        .floats("value", rows.iter().map(|g| g.value))
        .floats("seconds", rows.iter().map(|g| g.seconds.median))
        .floats("seconds_least", rows.iter().map(|g| g.seconds.least))
        .floats("seconds_most", rows.iter().map(|g| g.seconds.most))
        .integers("runs", rows.iter().map(|g| g.seconds.runs as u64))
        .floats("seconds_planned", rows.iter().map(|g| g.planned))
        .floats("off", rows.iter().map(|g| g.seconds.median / g.planned / pace))
}

/// `growth_exponents.csv`: a row per ladder of sizes.
fn exponents(all: &Benchmark) -> Table {
    let rows = &all.exponents;
    Table::new()
        .text("of", rows.iter().map(|e| e.of.into()))
        .text("variable", rows.iter().map(|e| e.variable.into()))
        .optional("exponent", rows.iter().map(|e| Some(e.measured?[0])))
        .optional("exponent_se", rows.iter().map(|e| Some(e.measured?[1])))
        .optional("exponent_planned", rows.iter().map(|e| e.planned))
}

/// `skipped.csv`: a row per scene.
fn skipped(all: &Benchmark) -> Table {
    let rows = &all.skipped;
    let part = |done: u64, plain: u64| (plain > 0).then(|| done as f64 / plain as f64);
    Table::new()
        .text("scene", rows.iter().map(|s| s.scene.clone()))
        .integers("pairs", rows.iter().map(|s| s.done.pairs))
        .integers("pairs_plain", rows.iter().map(|s| s.plain.pairs))
        .optional("pairs_part", rows.iter().map(|s| part(s.done.pairs, s.plain.pairs)))
        .integers("products", rows.iter().map(|s| s.done.products))
        .integers("products_plain", rows.iter().map(|s| s.plain.products))
        .optional("products_part", rows.iter().map(|s| part(s.done.products, s.plain.products)))
        .integers("bytes", rows.iter().map(|s| s.done.bytes))
        .integers("bytes_plain", rows.iter().map(|s| s.plain.bytes))
        .optional("bytes_part", rows.iter().map(|s| part(s.done.bytes, s.plain.bytes)))
        .floats("seconds", rows.iter().map(|s| s.seconds))
}

/// `calibration.csv`: a row per problem and method.
fn calibration(rows: &[&Explained]) -> Table {
    let yes = |is: bool| if is { "yes" } else { "" }.to_string();
    Table::new()
        .text("device", rows.iter().map(|e| e.device.clone()))
        .text("problem", rows.iter().map(|e| e.problem.clone()))
        .text("method", rows.iter().map(|e| e.method.clone()))
        .floats("seconds", rows.iter().map(|e| e.seconds))
        .floats("seconds_built_in", rows.iter().map(|e| e.built_in))
        .floats("seconds_measured", rows.iter().map(|e| e.measured))
        .floats("off", rows.iter().map(|e| e.seconds / e.measured))
        .text("chosen", rows.iter().map(|e| yes(e.chosen)))
        .text("fastest", rows.iter().map(|e| yes(e.fastest)))
}

/// The measured parts, and how well they explain what was timed.
fn calibration_text(found: &Calibration) -> String {
    let mut text = String::new();
    for (device, measured) in &found.costs.devices {
        let parts: Vec<_> = measured.pairs.iter().chain(&measured.waves).collect();
        let table = Table::new()
            .text("part", parts.iter().map(|(name, _)| (*name).clone()))
            .floats("nanoseconds", parts.iter().map(|(_, value)| **value));
        let heading = format!("what the parts of methods cost on {device}");
        let _ = write!(text, "\n{}", some_columns(&heading, &["part", "nanoseconds"], &table));
    }
    let [measured, built_in] = found.typical_errors();
    let missed: Vec<_> = found.missed().collect();
    let _ = writeln!(
        text,
        "\nof {} problems and methods, these costs miss the time typically by {:.0} % (built-in ones, at the pace of this machine, by {:.0} %), {} by more than 15 %; at worst the chosen method takes {:.2} times as long as the best",
        found.explained.len(),
        100.0 * (measured - 1.0),
        100.0 * (built_in - 1.0),
        missed.len(),
        found.worst_choice(),
    );
    if !missed.is_empty() {
        let columns = ["problem", "method", "seconds", "seconds_measured", "off"];
        let _ = write!(text, "{}", some_columns("those missed by more", &columns, &calibration(&missed)));
    }
    text
}

/// All that have rows, by the names of their files.
pub(super) fn all(all: &Benchmark) -> Vec<(&'static str, Table)> {
    let tables = [
        ("bench.csv", ways(all)),
        ("efficiency.csv", efficiency(all)),
        ("calibration.csv", calibration(&all.calibration.iter().flat_map(|c| &c.explained).collect::<Vec<_>>())),
        ("growth.csv", growth(all, &all.grown)),
        ("growth_exponents.csv", exponents(all)),
        ("skipped.csv", skipped(all)),
    ];
    tables.into_iter().filter(|(_, table)| table.rows() > 0).collect()
}

/// For a terminal.
pub(super) fn text(all: &Benchmark) -> String {
    let mut text = format!("# {}\n", all.machine.words());
    for scene in &all.scenes {
        let columns =
            ["method", "seconds", "giga_per_s", "fma_share", "error_rms", "error_max", "k_as_accurate", "pareto"];
        let several = scene.ways.iter().any(|way| way.device != scene.ways[0].device);
        let columns: Vec<_> = columns.into_iter().chain(several.then_some("device")).collect();
        let heading = format!(
            "{}; error of {}, by chance {:.2e} of one realization",
            scene.name, scene.error_of, scene.statistical
        );
        let _ = write!(text, "\n{}", some_columns(&heading, &columns, &of(all, &[scene])));
    }
    if !all.efficiency.is_empty() {
        let largest = all.efficiency.iter().map(|e| e.n).max().unwrap_or(0);
        let rows = all.efficiency.iter().filter(|e| e.n == largest).cloned().collect();
        let part = Benchmark { efficiency: rows, ..all.clone() };
        let columns = [
            "sampler",
            "integrand",
            "n",
            "seconds_drawing",
            "seconds_evaluating",
            "error_rms",
            "error_rms_se",
            "efficiency",
            "efficiency_se",
        ];
        let heading =
            "errors of integrals and the time they take; efficiency: time of random points with the same error over it";
        let _ = write!(text, "\n{}", some_columns(heading, &columns, &efficiency(&part)));
    }
    if !all.skipped.is_empty() {
        let columns = ["scene", "pairs", "pairs_part", "products", "products_part", "bytes_part", "seconds"];
        let heading = "work that was done, and as a part of what a plain implementation does";
        let _ = write!(text, "\n{}", some_columns(heading, &columns, &skipped(all)));
    }
    if let Some(found) = &all.calibration {
        text.push_str(&calibration_text(found));
    }
    if !all.grown.is_empty() {
        let columns = ["of", "variable", "exponent", "exponent_se", "exponent_planned"];
        let _ = write!(text, "\n{}", some_columns("time grows like", &columns, &exponents(all)));
        let off: Vec<_> = all.mispredicted().cloned().collect();
        let pace = all.pace().unwrap_or(1.0);
        let _ = writeln!(
            text,
            "\nplans are off by a factor of {pace:.2} throughout, and beside that by more than 15 % in every run in {} of {} problems",
            off.len(),
            all.grown.len()
        );
        if !off.is_empty() {
            let columns = ["of", "variable", "value", "seconds", "seconds_planned", "off"];
            let _ = write!(text, "{}", some_columns("those", &columns, &growth(all, &off)));
        }
    }
    text
}
