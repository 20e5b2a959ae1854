//! g(r), its kernel estimate, g of two classes, and K.

mod classes;
mod counts;
mod figures;
mod kernel;
mod summary;
mod tables;

use super::group::{Ask, Parts};
use super::{Keys, Output, Room, Row, across, in_units};
use crate::display::human;
use crate::error::{Result, plural};
use crate::estimate::{Analysis, Curve, ErrorSource};
use crate::request::Statistic;

pub(crate) use counts::{Pairs, correction, identity, pairs_of};

/// Pairs.
pub(crate) struct Here;

impl Room for Here {
    fn plan(&self, ask: &Ask<'_>, parts: &mut Parts) -> Result<()> {
        if !(ask.wants(Statistic::Pcf) || ask.wants(Statistic::KFunction)) {
            return Ok(());
        }
        let bins = counts::bins(ask)?;
        let settings = counts::settings(ask)?;
        if settings.cumulative {
            counts::check_bins_of_k(ask.request, &bins, ask.domain)?;
        }
        let smoothed = kernel::plans(ask, &bins, settings)?;
        let pairs = Pairs::new(ask, bins, settings)?;
        let classes =
            (!ask.classes.is_empty()).then(|| classes::Classes::new(ask.request, ask.classes, &pairs)).transpose()?;
        parts.add(pairs);
        if let Some((search, smoothed)) = smoothed {
            search.into_iter().for_each(|search| parts.add(search));
            parts.add(smoothed);
        }
        classes.into_iter().for_each(|classes| parts.add(classes));
        Ok(())
    }

    fn curves(&self, a: &Analysis) -> Vec<Curve> {
        let curve = |name, r: &[f64], values: Vec<f64>| Curve { name, r: r.to_vec(), values };
        let (g, k) = (a.pair_correlation(), a.k_function());
        let curves = [
            g.map(|g| curve("g", &g.r, g.g.clone())),
            a.kernel().map(|k| curve("g_kernel", &k.r, k.g.iter().map(|v| v.unwrap_or(f64::NAN)).collect())),
            k.map(|k| curve("k", &k.r, k.k.clone())),
            k.map(|k| curve("l_minus_r", &k.r, k.l_minus_r.clone())),
        ];
        curves.into_iter().flatten().collect()
    }

    fn outputs(&self) -> &'static [Output] {
        const {
            &[
                Output::table("pcf.csv", tables::pcf)
                    .shown("pair correlation function", &["r", "g", "g_se", "g_kernel", "g_kernel_se"]),
                Output::table("pcf_cross.csv", tables::cross).shown("g of two classes", &["r", "g_"]),
                Output::table("k_function.csv", tables::k_function)
                    .shown("Ripley's K function", &["r", "k", "k_se", "l_minus_r", "l_se", "neighbors"]),
                Output::table("k_function_cross.csv", tables::cross_k)
                    .shown("L - r of two classes", &["r", "l_minus_r_"]),
                Output::figure("pcf.svg", figures::pcf, "Pair correlation function", figures::pcf_caption),
                Output::figure("pcf_cross.svg", figures::cross, "Two classes of points", figures::cross_caption),
                Output::figure("k_function.svg", figures::k_function, "Ripley's <i>K</i> function", figures::k_caption),
                Output::figure(
                    "k_function_cross.svg",
                    figures::cross_k,
                    "Ripley's <i>K</i> of two classes",
                    figures::cross_k_caption,
                ),
            ]
        }
    }

    fn summary(&self, a: &Analysis, keys: &mut Keys<'_>) -> serde_json::Result<()> {
        keys.add("pair_correlation", &summary::pair_correlation(a))?;
        keys.add("cross_correlation", &summary::cross(a))?;
        keys.add("k_function", &summary::k_function(a))?;
        keys.add("cross_k_function", &summary::cross_k(a))
    }

    fn accuracy(&self, a: &Analysis) -> Option<Row> {
        let counted = a.pair_correlation().is_some() || a.vector().is_some();
        counted.then(|| ("Accuracy of the pair counts".into(), "exact".into()))
    }

    fn errors(&self, a: &Analysis) -> Vec<Row> {
        let mut rows = Vec::new();
        if let Some(pcf) = a.pair_correlation() {
            rows.push(("<i>g</i>(<i>r</i>)".into(), of_pairs(a, pcf.errors, "each bin's <i>g</i>")));
        }
        if let Some(cross) = a.cross() {
            rows.push(("<i>g</i> of two classes".into(), of_pairs(a, cross.between.errors, "each bin's <i>g</i>")));
        }
        if let Some(k) = a.k_function().or(a.cross_k().map(|cross| &cross.between)) {
            let text = of_pairs(a, k.errors, "<i>K</i>");
            let edges = if a.domain.is_torus() || k.errors == ErrorSource::AcrossRealizations {
                ""
            } else {
                "; edge effects of the window add to it as <i>r</i> grows"
            };
            rows.push(("<i>K</i>(<i>r</i>), <i>L</i>(<i>r</i>)".into(), format!("{text}{edges}")));
        }
        if let Some(kernel) = a.kernel() {
            let text = match kernel.errors {
                ErrorSource::AcrossRealizations => across(a, "the estimate at each <i>r</i>"),
                _ => "theory, for a single realization: as if all pairs were independent (Poisson)".into(),
            };
            rows.push(("kernel estimate".into(), text));
        }
        rows
    }

    fn headline(&self, a: &Analysis) -> Vec<String> {
        let mut lines = Vec::new();
        if let Some(g) = a.pair_correlation() {
            let pairs: u64 = g.count.iter().sum();
            let range = format!("[{}, {})", human(g.r_lo[0]), human(g.r_hi[g.r_hi.len() - 1]));
            let (bins, pairs) = (plural(g.g.len() as u64, "bin"), plural(pairs, "ordered pair"));
            let which = if a.inhomogeneity().is_some() { ", inhomogeneous" } else { "" };
            lines.push(format!("g(r){which}: {bins} over {range}{}, {pairs}", in_units(a)));
        }
        if let Some(cross) = a.cross() {
            let pairs: u64 = cross.between.count.iter().sum();
            let [a, b] = &cross.classes;
            lines.push(format!("g of {a} and {b}: {} from {a} to {b}", plural(pairs, "pair")));
        }
        if let Some(cross) = a.cross_k()
            && let (Some(&r), Some(&l)) = (cross.between.r.last(), cross.between.l.last())
        {
            let [a, b] = &cross.classes;
            lines.push(format!("L of {a} and {b}: {} at r = {}, r if they are independent", human(l), human(r)));
        }
        if let Some(k) = a.k_function()
            && let (Some(&r), Some(&neighbors), Some(&above)) = (k.r.last(), k.neighbors.last(), k.l_minus_r.last())
        {
            let (neighbors, r, unit) = (human(neighbors), human(r), in_units(a));
            lines.push(match a.inhomogeneity() {
                None => format!("K(r): {neighbors} further points within {r}{unit} of a point, on average"),
                Some(_) => format!("K(r), inhomogeneous: L - r = {} at r = {r}{unit}", human(above)),
            });
        }
        lines
    }
}

/// What errors of sums of pairs rest on, `of` being what scatters across realizations.
fn of_pairs(a: &Analysis, errors: ErrorSource, of: &str) -> String {
    match errors {
        ErrorSource::AcrossRealizations => across(a, of),
        ErrorSource::Theory => "theory, for a single realization: Poisson counts of unordered pairs".into(),
        ErrorSource::SpectralTheory => {
            "theory, for a single realization: Poisson counts of unordered pairs, their variance \
                                        changed as the spectrum of these pairs says"
                .into()
        }
        ErrorSource::ClusterTheory => {
            "theory, for a single realization of clusters: that of the Thomas process with these \
                                       pairs, found by maximum Palm likelihood (Tanaka et al. 2008)"
                .into()
        }
    }
}
