//! Tables: named columns, and the CSV files made of them.

use crate::analysis::Analysis;

/// Columns of equal length.
pub(super) struct Table {
    columns: Vec<(&'static str, Vec<String>)>,
}

/// A float as the shortest decimal that reads back as the same f64, zero without a sign; undefined or infinite: empty.
fn cell(x: f64) -> String {
    if x.is_finite() { format!("{:?}", x + 0.0) } else { String::new() }
}

impl Table {
    fn new() -> Self {
        Self { columns: Vec::new() }
    }

    fn floats(mut self, name: &'static str, values: impl IntoIterator<Item = f64>) -> Self {
        self.columns.push((name, values.into_iter().map(cell).collect()));
        self
    }

    fn optional(self, name: &'static str, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.floats(name, values.into_iter().map(|v| v.unwrap_or(f64::NAN)))
    }

    fn integers(mut self, name: &'static str, values: impl IntoIterator<Item = u64>) -> Self {
        self.columns.push((name, values.into_iter().map(|v| v.to_string()).collect()));
        self
    }

    /// The table as CSV: one header line, then one line per row.
    pub(super) fn csv(&self) -> std::io::Result<Vec<u8>> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns.iter().map(|c| c.0))?;
        let rows = self.columns.iter().map(|c| c.1.len()).max().unwrap_or(0);
        for row in 0..rows {
            // A column that is too short leaves cells empty; the reader sees a hole, not a shifted table.
            writer.write_record(self.columns.iter().map(|c| c.1.get(row).map_or("", String::as_str)))?;
        }
        writer.into_inner().map_err(|e| e.into_error())
    }
}

/// `pcf.csv`: r in the domain's length unit, `count` ordered pairs over all realizations, g dimensionless.
pub(super) fn pcf(analysis: &Analysis) -> Option<Table> {
    let pcf = analysis.pair_correlation.as_ref()?;
    let table = Table::new()
        .floats("r_lo", pcf.r_lo.iter().copied())
        .floats("r", pcf.r.iter().copied())
        .floats("r_hi", pcf.r_hi.iter().copied())
        .integers("count", pcf.count.iter().copied())
        .floats("g", pcf.g.iter().copied())
        .floats("g_se", pcf.g_se.iter().copied());
    Some(match &analysis.kernel {
        Some(kernel) => {
            table.optional("g_kernel", kernel.g.iter().copied()).optional("g_kernel_se", kernel.g_se.iter().copied())
        }
        None => table,
    })
}

/// `k_function.csv`: at distances r, in the domain's length unit; K in units of its measure.
pub(super) fn k_function(analysis: &Analysis) -> Option<Table> {
    let k = analysis.k_function.as_ref()?;
    Some(
        Table::new()
            .floats("r", k.r.iter().copied())
            .floats("k", k.k.iter().copied())
            .floats("k_se", k.k_se.iter().copied())
            .floats("l", k.l.iter().copied())
            .optional("l_se", k.l_se.iter().copied())
            .floats("l_minus_r", k.l.iter().zip(&k.r).map(|(l, r)| l - r))
            .floats("neighbors", k.neighbors.iter().copied()),
    )
}

/// `pcf_cross.csv`: as `pcf.csv` for two classes a and b; `count_ab` are ordered pairs from a to b.
pub(super) fn cross(analysis: &Analysis) -> Option<Table> {
    let cross = analysis.cross.as_ref()?;
    let [a, b, ab] = [&cross.a, &cross.b, &cross.between];
    let mut table = Table::new()
        .floats("r_lo", ab.r_lo.iter().copied())
        .floats("r", ab.r.iter().copied())
        .floats("r_hi", ab.r_hi.iter().copied());
    for (names, g) in [
        (["count_aa", "g_aa", "g_aa_se"], a),
        (["count_bb", "g_bb", "g_bb_se"], b),
        (["count_ab", "g_ab", "g_ab_se"], ab),
    ] {
        table = table
            .integers(names[0], g.count.iter().copied())
            .floats(names[1], g.g.iter().copied())
            .floats(names[2], g.g_se.iter().copied());
    }
    Some(table)
}

/// `spectrum_radial.csv`: nu in cycles per unit length, P dimensionless, anisotropy in dB.
pub(super) fn radial(analysis: &Analysis) -> Option<Table> {
    let radial = analysis.radial.as_ref()?;
    let rings = &radial.rings;
    Some(
        Table::new()
            .floats("nu_lo", rings.iter().map(|r| r.nu_lo))
            .floats("nu", rings.iter().map(|r| r.nu))
            .floats("nu_hi", rings.iter().map(|r| r.nu_hi))
            .integers("modes", rings.iter().map(|r| r.modes))
            .floats("p", rings.iter().map(|r| r.p))
            .floats("p_se", rings.iter().map(|r| r.p_se))
            .optional("anisotropy_db", rings.iter().map(|r| r.anisotropy_db))
            .floats("anisotropy_reference_db", rings.iter().map(|_| radial.anisotropy_reference_db))
            .optional("anisotropy_db_se", rings.iter().map(|r| r.anisotropy_db_se))
            .integers("independent_modes", rings.iter().map(|r| r.independent_modes)),
    )
}
