//! Tables: named columns, and the CSV files made of them.

use crate::estimate::{Analysis, Band, Envelope};

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

    fn text(mut self, name: &'static str, values: impl IntoIterator<Item = String>) -> Self {
        self.columns.push((name, values.into_iter().collect()));
        self
    }

    /// `p_lo`, `p_hi`, and in `p_band` what they rest on.
    fn bands(self, bands: impl Iterator<Item = Option<Band>> + Clone) -> Self {
        self.optional("p_lo", bands.clone().map(|b| Some(b?.lo)))
            .optional("p_hi", bands.clone().map(|b| Some(b?.hi)))
            .text("p_band", bands.map(|b| b.map_or(String::new(), |b| b.law.name().to_string())))
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
    let pcf = analysis.pair_correlation()?;
    let table = Table::new()
        .floats("r_lo", pcf.r_lo.iter().copied())
        .floats("r", pcf.r.iter().copied())
        .floats("r_hi", pcf.r_hi.iter().copied())
        .integers("count", pcf.count.iter().copied())
        .floats("g", pcf.g.iter().copied())
        .floats("g_se", pcf.g_se.iter().copied());
    Some(match analysis.kernel() {
        Some(kernel) => {
            table.optional("g_kernel", kernel.g.iter().copied()).optional("g_kernel_se", kernel.g_se.iter().copied())
        }
        None => table,
    })
}

/// `k_function.csv`: at distances r, in the domain's length unit; K in units of its measure.
pub(super) fn k_function(analysis: &Analysis) -> Option<Table> {
    let k = analysis.k_function()?;
    Some(
        Table::new()
            .floats("r", k.r.iter().copied())
            .floats("k", k.k.iter().copied())
            .floats("k_se", k.k_se.iter().copied())
            .floats("l", k.l.iter().copied())
            .optional("l_se", k.l_se.iter().copied())
            .floats("l_minus_r", k.l_minus_r.iter().copied())
            .floats("neighbors", k.neighbors.iter().copied()),
    )
}

/// `pcf_cross.csv`: as `pcf.csv` for two classes a and b; `count_ab` are ordered pairs from a to b.
pub(super) fn cross(analysis: &Analysis) -> Option<Table> {
    let cross = analysis.cross()?;
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

/// `envelope.csv`: every curve after the other, in the units of its own table.
pub(super) fn envelope(analysis: &Analysis) -> Option<Table> {
    let curves = &analysis.envelopes()?.curves;
    let column = |of: fn(&Envelope) -> &[f64]| curves.iter().flat_map(move |c| of(c).iter().copied());
    let names = curves.iter().flat_map(|c| std::iter::repeat_n(c.observed.name.to_string(), c.observed.r.len()));
    Some(
        Table::new()
            .text("curve", names)
            .floats("r", column(|c| &c.observed.r))
            .floats("observed", column(|c| &c.observed.values))
            .floats("lo", column(|c| &c.pointwise[0]))
            .floats("hi", column(|c| &c.pointwise[1]))
            .floats("global_lo", column(|c| &c.global[0]))
            .floats("global_hi", column(|c| &c.global[1])),
    )
}

/// `pcf_angular.csv`: one row per ring and sector, angles in radians; `cells` and `count` are of one of each mirror pair.
pub(super) fn angular(analysis: &Analysis) -> Option<Table> {
    let sectors = &analysis.vector()?.sectors;
    if sectors.is_empty() {
        return None;
    }
    Some(
        Table::new()
            .floats("r_lo", sectors.iter().map(|s| s.r[0]))
            .floats("r", sectors.iter().map(|s| s.r[1]))
            .floats("r_hi", sectors.iter().map(|s| s.r[2]))
            .floats("theta_lo", sectors.iter().map(|s| s.theta[0]))
            .floats("theta", sectors.iter().map(|s| s.theta[1]))
            .floats("theta_hi", sectors.iter().map(|s| s.theta[2]))
            .integers("cells", sectors.iter().map(|s| s.cells))
            .integers("count", sectors.iter().map(|s| s.count))
            .optional("g", sectors.iter().map(|s| s.g))
            .optional("g_se", sectors.iter().map(|s| s.g_se)),
    )
}

/// `spectrum_radial.csv`: nu in cycles per unit length, P dimensionless, anisotropy in dB.
pub(super) fn radial(analysis: &Analysis) -> Option<Table> {
    let radial = analysis.radial()?;
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
            .integers("independent_modes", rings.iter().map(|r| r.independent_modes))
            .bands(rings.iter().map(|r| r.band))
            .floats("m", rings.iter().map(|r| r.m)),
    )
}

/// `spectrum_axes.csv`: m in cycles per side of its axis, nu in cycles per unit length.
pub(super) fn axes(analysis: &Analysis) -> Option<Table> {
    let modes = &analysis.details()?.axes.modes;
    (!modes.is_empty()).then(|| {
        Table::new()
            .text("axis", modes.iter().map(|m| ["x", "y", "z"][m.axis].to_string()))
            .text("m", modes.iter().map(|m| m.m.to_string()))
            .floats("nu", modes.iter().map(|m| m.nu))
            .floats("p", modes.iter().map(|m| m.p))
            .floats("p_se", modes.iter().map(|m| m.p_se))
            .bands(modes.iter().map(|m| m.band))
    })
}

/// `spectrum_angular.csv`: directions of nu = m / L in degrees from the x axis; `ratio` is P over what the ring means make of
/// the same modes.
pub(super) fn sectors(analysis: &Analysis) -> Option<Table> {
    let sectors = &analysis.details()?.angular.as_ref()?.sectors;
    Some(
        Table::new()
            .floats("theta_lo", sectors.iter().map(|s| s.theta[0].to_degrees()))
            .floats("theta_hi", sectors.iter().map(|s| s.theta[2].to_degrees()))
            .integers("modes", sectors.iter().map(|s| s.modes))
            .floats("p", sectors.iter().map(|s| s.p))
            .floats("p_se", sectors.iter().map(|s| s.p_se))
            .bands(sectors.iter().map(|s| s.band))
            .optional("ratio", sectors.iter().map(|s| s.ratio))
            .optional("ratio_se", sectors.iter().map(|s| s.ratio_se)),
    )
}

/// `spectrum_from_pcf.csv`: ring means of P and what g makes of them, with pairs beyond r_max taken as uncorrelated.
pub(super) fn spectrum_from_pcf(analysis: &Analysis) -> Option<Table> {
    let s = analysis.details()?.of_pcf.as_ref()?;
    Some(
        Table::new()
            .floats("nu", s.nu.iter().copied())
            .floats("p", s.p.iter().copied())
            .floats("p_from_g", s.p_from_g.iter().copied()),
    )
}

/// `pcf_from_spectrum.csv`: g and what the ring means of P make of it, with P = 1 beyond the last ring.
pub(super) fn pcf_from_spectrum(analysis: &Analysis) -> Option<Table> {
    let s = analysis.details()?.of_pcf.as_ref()?;
    Some(
        Table::new()
            .floats("r", s.r.iter().copied())
            .floats("g", s.g.iter().copied())
            .floats("g_from_p", s.g_from_p.iter().copied()),
    )
}

/// `spectrum_list.csv`: the wave vectors of a list in its order, m in cycles per side, nu in cycles per unit length, P
/// dimensionless with its 95 % band.
pub(super) fn spectrum_list(analysis: &Analysis) -> Option<Table> {
    let spectrum = analysis.spectrum().filter(|s| analysis.grid_wanted && s.waves.grid().is_none())?;
    let (domain, dim) = (&analysis.domain, analysis.domain.dim());
    let modes = || 0..spectrum.p.len();
    let vectors = || modes().map(|k| spectrum.waves.vector(k));
    let mut table = Table::new();
    for (axis, name) in ["m_x", "m_y", "m_z"].into_iter().enumerate().take(dim) {
        table = if domain.is_torus() {
            table.text(name, vectors().map(|m| (m[axis] as i64).to_string()))
        } else {
            table.floats(name, vectors().map(|m| m[axis]))
        };
    }
    for (axis, name) in ["nu_x", "nu_y", "nu_z"].into_iter().enumerate().take(dim) {
        table = table.floats(name, modes().map(|k| spectrum.waves.frequency(k, domain)[axis]));
    }
    let bands = spectrum.bands();
    Some(
        table
            .floats("nu", modes().map(|k| spectrum.waves.frequency_length(k, domain)))
            .floats("p", spectrum.p.iter().copied())
            .floats("p_se", spectrum.p_se.iter().copied())
            .bands(bands.iter().copied()),
    )
}

/// `neighbor_functions.csv`: r in the domain's length unit, the rest dimensionless.
pub(super) fn neighbor_functions(analysis: &Analysis) -> Option<Table> {
    let functions = &analysis.neighbors()?.functions;
    Some(
        Table::new()
            .floats("r", functions.r.iter().copied())
            .optional("g_function", functions.g.iter().copied())
            .optional("g_function_se", functions.g_se.iter().copied())
            .optional("f_function", functions.f.iter().copied())
            .optional("f_function_se", functions.f_se.iter().copied())
            .optional("j_function", functions.j.iter().copied())
            .floats("poisson", functions.poisson.iter().copied()),
    )
}
