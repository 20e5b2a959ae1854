//! Tables of P: over rings, at a list, along axes, by direction, and against g.

use crate::estimate::Analysis;
use crate::statistics::Table;

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
            .floats("m", rings.iter().map(|r| r.m))
            .floats("nu_mean", rings.iter().map(|r| r.nu_mean))
            .floats("m_mean", rings.iter().map(|r| r.m_mean)),
    )
}

/// `spectrum_list.csv`: the wave vectors of a list in its order, m in cycles per side, nu in cycles per unit length, P
/// dimensionless with its 95 % band.
pub(super) fn spectrum_list(analysis: &Analysis) -> Option<Table> {
    let spectrum = analysis.listed_power()?;
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
