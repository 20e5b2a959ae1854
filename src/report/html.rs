//! `report.html`: one page that needs nothing else: no script, no font, no file beside it.

use std::fmt::Write as _;

use base64::Engine as _;

use super::covariance_image::CovarianceImage;
use super::points_picture;
use super::spectrum_image::{SpectrumImage, tone_text};
use super::spectrum_numbers;
use super::vector_image::VectorImage;
use crate::compute::Backend;
use crate::display::{diverging, escape, human, kernel_name, packing_symbol, sequential, size, with_error};
use crate::estimate::{Analysis, ErrorSource, Normalization, VectorCorrelation};
use crate::plan::{Convention, Correction};

/// The pictures of one report, as far as there are any.
#[derive(Default)]
pub(super) struct Pictures {
    pub(super) pcf: Option<String>,
    pub(super) cross: Option<String>,
    pub(super) k_function: Option<String>,
    pub(super) pcf_vector: Option<VectorImage>,
    pub(super) pcf_angular: Option<String>,
    pub(super) spectrum_radial: Option<String>,
    pub(super) anisotropy: Option<String>,
    pub(super) spectrum_axes: Option<String>,
    pub(super) spectrum_angular: Option<String>,
    pub(super) neighbor_functions: Option<String>,
    pub(super) spectrum: Option<SpectrumImage>,
    pub(super) covariance: Option<CovarianceImage>,
    pub(super) points: Option<String>,
}

const STYLE: &str = "
:root { color-scheme: light; }
body { font: 16px/1.5 Helvetica, Arial, 'Liberation Sans', sans-serif; color: #222; background: #fff;
  max-width: 940px; margin: 0 auto; padding: 24px 16px 64px; overflow-wrap: anywhere; }
h1 { font-size: 1.5rem; line-height: 1.25; margin: 0 0 .25rem; }
h2 { font-size: 1.15rem; margin: 2.5rem 0 .5rem; border-bottom: 1px solid #ddd; padding-bottom: .25rem; }
p.lead { color: #555; margin: 0 0 1rem; }
.warnings { border-left: 4px solid #d55e00; background: #fdf3ec; padding: .6rem 1rem; margin: 1rem 0; }
.warnings ul { margin: .25rem 0 0; padding-left: 1.2rem; }
table { border-collapse: collapse; width: 100%; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .3rem .75rem .3rem 0; border-bottom: 1px solid #eee; }
th { font-weight: normal; color: #555; width: 42%; }
sub, sup { line-height: 0; }
figure { margin: 1.25rem 0 2rem; }
figure .picture { overflow-x: auto; }
figure svg { display: block; width: 100%; min-width: 620px; height: auto; }
figure img { display: block; width: 100%; max-width: 640px; height: auto; margin: 0 auto; image-rendering: pixelated; }
figcaption { color: #444; font-size: .95rem; margin-top: .5rem; }
.scale { max-width: 640px; margin: .5rem auto 0; font-size: .85rem; }
.scale span { display: block; height: 12px; }
.scale div { display: flex; justify-content: space-between; }
.scale p { position: relative; height: 1.6em; margin: 0; }
.scale p i { position: absolute; transform: translateX(-50%); white-space: nowrap; }
pre { background: #f6f6f6; padding: .75rem 1rem; overflow-x: auto; font-size: .85rem; line-height: 1.4; }
footer { color: #777; font-size: .85rem; margin-top: 3rem; }
";

/// The page.
pub(super) fn page(analysis: &Analysis, pictures: &Pictures) -> String {
    let a = analysis;
    let mut html = String::new();
    let _ = write!(
        html,
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{subject} – pairwave</title>\n<style>{STYLE}</style>\n</head>\n<body>\n\
         <h1>{subject}</h1>\n<p class=\"lead\">{}; {}</p>\n",
        domain(a),
        size(a),
        subject = escape(&a.subject),
    );
    if !a.warnings.is_empty() {
        html.push_str("<div class=\"warnings\" role=\"note\"><strong>Warnings</strong>\n<ul>\n");
        for warning in &a.warnings {
            let _ = writeln!(html, "<li>{}</li>", escape(warning));
        }
        html.push_str("</ul></div>\n");
    }
    html.push_str("<h2>At a glance</h2>\n");
    table(&mut html, &scalars(a));
    figures(&mut html, a, pictures);
    errors(&mut html, a);

    html.push_str("<h2>How it was computed</h2>\n");
    if let Some((_, command)) = a.parameters.iter().find(|(name, _)| name == "command") {
        let _ = writeln!(html, "<p>Command:</p>\n<pre>{}</pre>", escape(command));
    }
    let _ = writeln!(html, "<pre>{}</pre>", escape(a.plan.trim_end()));
    let backends: Vec<_> = a.computed_by.backends.iter().map(|b| backend(*b)).collect();
    let mut rows = vec![
        ("Device".into(), escape(&a.computed_by.device())),
        ("Backend".into(), backends.join(", ")),
        ("Program".into(), concat!("pairwave ", env!("CARGO_PKG_VERSION")).into()),
    ];
    if a.pair_correlation().is_some() || a.vector().is_some() {
        rows.push(("Accuracy of the pair counts".into(), "exact".into()));
    }
    if a.spectrum().is_some() {
        let bound = human(a.accuracy.power_bound().max_any(a.shape.max_points as f64));
        let name = a.accuracy.name();
        rows.push((
            "Accuracy of P".into(),
            format!("{name}: |<i>P</i> − <i>P</i><sub>exact</sub>| ≤ {bound} (1 + <i>P</i>)"),
        ));
    }
    let seconds: f64 = a.timings.iter().map(|t| t.1).sum();
    if !a.timings.is_empty() {
        let stages: Vec<_> = a.timings.iter().map(|(s, t)| format!("{} {t:.3}", escape(s))).collect();
        rows.push(("Time".into(), format!("{seconds:.3} s ({})", stages.join(", "))));
    }
    table(&mut html, &rows);
    if !a.parameters.is_empty() {
        html.push_str("<h2>Parameters</h2>\n");
        let rows: Vec<_> = a.parameters.iter().map(|(n, v)| (escape(n), escape(v))).collect();
        table(&mut html, &rows);
    }
    html.push_str("<footer>The numbers behind the pictures are in the CSV and NPY files next to this page.</footer>\n");
    html.push_str("</body>\n</html>\n");
    html
}

/// Rows of (name, value), both HTML.
fn table(html: &mut String, rows: &[(String, String)]) {
    html.push_str("<table>\n");
    for (name, value) in rows {
        let _ = writeln!(html, "<tr><th scope=\"row\">{name}</th><td>{value}</td></tr>");
    }
    html.push_str("</table>\n");
}

fn backend(backend: Backend) -> &'static str {
    match backend {
        Backend::Reference => "reference",
        Backend::Cpu => "cpu",
        Backend::Gpu => "gpu",
    }
}

/// `unit torus in 2D`, `window [0, 2] × [1, 3]`.
fn domain(a: &Analysis) -> String {
    let domain = &a.domain;
    let dim = domain.dim();
    if domain.is_torus() {
        if domain.sides().iter().all(|&s| s == 1.0) {
            return format!("unit torus in {dim}D");
        }
        let sides: Vec<_> = domain.sides().iter().map(|&s| human(s)).collect();
        return format!("torus in {dim}D with sides {}", sides.join(" × "));
    }
    let ranges: Vec<_> = domain
        .origin()
        .iter()
        .zip(domain.sides())
        .map(|(&o, &s)| format!("[{}, {}]", human(o), human(o + s)))
        .collect();
    format!("window {}", ranges.join(" × "))
}

/// A bar of the colours of `sequential` with ticks.
fn color_bar(ticks: &[(f64, String)]) -> String {
    let stops = (0..=16).map(|k| sequential(f64::from(k) / 16.0)).map(|[r, g, b]| format!("#{r:02x}{g:02x}{b:02x}"));
    let stops = stops.collect::<Vec<_>>().join(", ");
    let labels: String =
        ticks.iter().map(|(at, label)| format!("<i style=\"left: {:.2}%\">{label}</i>", 100.0 * at)).collect();
    format!(
        "<div class=\"scale\"><span style=\"background: linear-gradient(to right, {stops})\"></span><p>{labels}</p></div>"
    )
}

/// `length units`, squared or cubed.
fn per_measure(dim: usize) -> &'static str {
    match dim {
        1 => "per unit length",
        2 => "per unit area",
        _ => "per unit volume",
    }
}

fn scalars(a: &Analysis) -> Vec<(String, String)> {
    let dim = a.domain.dim();
    let n = if a.min_points == a.shape.max_points {
        a.shape.max_points.to_string()
    } else {
        format!("{} to {}, mean {}", a.min_points, a.shape.max_points, human(a.shape.mean_points))
    };
    let (d, which) = packing_symbol(dim);
    let symbol = format!("<i>{d}</i><sub>{which}</sub>");
    let mut rows: Vec<(String, String)> = vec![
        ("Points per realization <i>n</i>".into(), n),
        ("Realizations <i>K</i>".into(), a.shape.realizations.to_string()),
        (
            "Intensity <i>λ</i>".into(),
            format!("{} {}", human(a.shape.mean_points / a.domain.measure()), per_measure(dim)),
        ),
        (
            format!("Closest-packing distance {symbol}"),
            format!("{} length units", human(a.domain.closest_packing_distance(a.shape.mean_points))),
        ),
    ];
    if let Some(neighbors) = a.neighbors() {
        let nn = &neighbors.distances;
        let relative = |r: Option<f64>| r.map_or(String::new(), |r| format!(" ({} {symbol})", human(r)));
        let value = |v: Option<f64>, se, r| {
            v.map_or("undefined: no realization has two points".into(), |v| {
                format!("{} length units{}", with_error(v, se), relative(r))
            })
        };
        rows.push(("Smallest nearest-neighbour distance".into(), value(nn.minimum, None, nn.minimum_relative)));
        if a.shape.realizations >= 2 {
            let mean = value(nn.mean_minimum, nn.mean_minimum_se, nn.mean_minimum_relative);
            rows.push(("The smallest of each realization, mean".into(), mean));
        }
        rows.push(("Mean nearest-neighbour distance".into(), value(nn.mean, nn.mean_se, nn.mean_relative)));
        if let Ok(bonds) = &neighbors.bonds {
            let [local, global] = [(bonds.local, bonds.local_se), (bonds.global, bonds.global_se)]
                .map(|(value, se)| with_error(value, se));
            let shares = bonds.with_5_6_7_neighbors.map(human).join(", ");
            rows.push(("Bond order, mean of |<i>ψ</i><sub>6</sub>|".into(), local));
            rows.push(("Bond order, |mean of <i>ψ</i><sub>6</sub>|".into(), global));
            rows.push(("Shares of points with 5, 6, 7 neighbours".into(), shares));
        }
    }
    if let Some((spectrum, (p, se))) = a.spectrum().and_then(|s| Some((s, s.dc()?))) {
        let se = (spectrum.errors == ErrorSource::AcrossRealizations).then_some(se);
        rows.push(("<i>P</i> at zero frequency, ∑<i>n</i><sup>2</sup> / ∑<i>n</i>".into(), with_error(p, se)));
    }
    if let Some(radial) = a.radial() {
        let db = human(radial.anisotropy_reference_db);
        rows.push(("Anisotropy if isotropic".into(), format!("{db} dB")));
    }
    if let Some(details) = a.details() {
        rows.extend(spectrum_numbers::rows(details));
    }
    rows.push(("Coinciding points".into(), a.duplicates.to_string()));
    if !a.closed_form.name.is_empty() {
        rows.push(("Closed form".into(), escape(&a.closed_form.name)));
    }
    rows
}

fn figures(html: &mut String, a: &Analysis, pictures: &Pictures) {
    let figure = |html: &mut String, picture: &str, caption: &str| {
        let _ = write!(
            html,
            "<figure><div class=\"picture\">{picture}</div>\n<figcaption>{caption}</figcaption></figure>\n"
        );
    };
    if let (Some(svg), Some(pcf)) = (&pictures.pcf, a.pair_correlation()) {
        html.push_str("<h2>Pair correlation function</h2>\n");
        let pairs = match pcf.normalization {
            Normalization::Pairs => "<i>n</i>(<i>n</i> − 1)",
            Normalization::Intensity => "<i>n</i><sup>2</sup>",
        };
        let kernel = a.kernel().map_or(String::new(), |k| {
            format!(
                " The second curve is smoothed with {} {} kernel whose standard deviation is {} length units.",
                if k.kernel.shape == crate::plan::SmoothingKernel::Epanechnikov { "an" } else { "a" },
                kernel_name(k.kernel.shape),
                human(k.kernel.bandwidth)
            )
        });
        let weights = match a.correction {
            Correction::None => "",
            Correction::Translation => {
                " (each weighing |<i>D</i>| / |<i>D</i> ∩ (<i>D</i> + <i>h</i>)|, <i>h</i> being the vector between the points)"
            }
            Correction::Isotropic => {
                " (each weighing the inverse of the part inside <i>D</i> of the sphere about the first point through the second)"
            }
            Correction::Border => " (seen from points at least as far from the border)",
        };
        let caption = format!(
            "<i>g</i>(<i>r</i>) = |<i>D</i>| ∑<sub><i>k</i></sub> <i>c<sub>k</sub></i> / \
             (<i>v</i> ∑<sub><i>k</i></sub> {pairs}): <i>c<sub>k</sub></i> ordered pairs{weights} of realization <i>k</i> at \
             distance <i>r</i> ± half a bin, over the number expected of independent points, with <i>v</i> the \
             measure of the shell and |<i>D</i>| that of the domain; 1 means no correlation.{kernel}"
        );
        let caption = caption + &envelope(a, &["g", "g_kernel"]);
        figure(html, svg, &caption);
    }
    if let (Some(svg), Some(cross)) = (&pictures.cross, a.cross()) {
        let [a, b] = cross.classes.each_ref().map(|name| escape(name));
        html.push_str("<h2>Two classes of points</h2>\n");
        let caption = format!(
            "<i>g</i> of the classes {a} (<i>A</i>) and {b} (<i>B</i>) alone, as above, and between them: \
             <i>g<sub>AB</sub></i>(<i>r</i>) = |<i>D</i>| ∑<sub><i>k</i></sub> <i>c<sub>AB</sub></i> / \
             (<i>v</i> ∑<sub><i>k</i></sub> <i>n<sub>A</sub> n<sub>B</sub></i>) with <i>c<sub>AB</sub></i> ordered pairs \
             from <i>A</i> to <i>B</i>, both directions averaged; 1 means that the classes are independent of each other."
        );
        figure(html, svg, &caption);
    }
    if let (Some(svg), Some(_)) = (&pictures.k_function, a.k_function()) {
        let (root, ball) = match a.domain.dim() {
            1 => ("<i>K</i> / 2", "length of an interval"),
            2 => ("√(<i>K</i> / π)", "area of a disk"),
            _ => ("∛(3 <i>K</i> / 4π)", "volume of a ball"),
        };
        html.push_str("<h2>Ripley's <i>K</i> function</h2>\n");
        let caption = format!(
            "<i>L</i>(<i>r</i>) − <i>r</i> with <i>L</i> = {root}: <i>λK</i>(<i>r</i>) is the mean number of further points \
             within <i>r</i> of a point. For independent points <i>K</i> is the {ball} of radius <i>r</i>, and \
             <i>L</i> = <i>r</i>; above 0 points have more neighbours than that, below fewer. Values at different <i>r</i> \
             share their pairs: they are correlated.{}",
            envelope(a, &["k", "l_minus_r"])
        );
        figure(html, svg, &caption);
    }
    if let Some(vector) = a.vector() {
        html.push_str("<h2>Pair correlation function of the vector</h2>\n");
        vector_figures(html, vector, pictures, figure);
    }
    if pictures.spectrum_radial.is_some() || pictures.spectrum.is_some() {
        html.push_str("<h2>Power spectrum</h2>\n");
    }
    let definition = "<i>P</i>(<b>m</b>) = ∑<sub><i>k</i></sub> \
        |∑<sub><i>j</i></sub> exp(−2π<i>i</i> <b>m</b>·<b>x</b><sub><i>j</i></sub>/<i>L</i>)|<sup>2</sup> / \
        ∑<sub><i>k</i></sub> <i>n<sub>k</sub></i>";
    if let Some(spectrum) = a.spectrum().filter(|s| a.grid_wanted && s.waves.grid().is_none()) {
        let _ = writeln!(
            html,
            "<h2>Power spectrum</h2>\n<p>{definition} at {} listed wave vectors: see spectrum_list.csv.</p>",
            spectrum.p.len()
        );
    }
    if let Some(svg) = &pictures.spectrum_radial {
        let rings = match a.convention {
            Convention::Ours => {
                "the modes with |<b>m</b>/<i>L</i>| in rings around <i>ν</i>, zero frequency left out".into()
            }
            other => format!("the rings of {other} (<i>ν</i> in {})", other.labels()),
        };
        let caption = format!(
            "{definition}, averaged over {rings}; 1 is the level of independent points. The wider band holds the \
             expectation with probability 95 %: by the chi-squared law of exponential ordinates, or from 30 realizations and \
             100 ordinates on by the standard error across realizations."
        );
        figure(html, svg, &caption);
    }
    if let Some(svg) = &pictures.anisotropy {
        let caption = "10 log<sub>10</sub>(<i>s</i><sup>2</sup> / <i>P</i>(<i>ν</i>)<sup>2</sup>) in dB, with \
             <i>s</i><sup>2</sup> the variance of <i>P</i>(<b>m</b>) over the independent modes of a ring; an isotropic \
             spectrum that is the average of <i>K</i> independent ones (of realizations, and of each one's tapers) scatters \
             around −10 log<sub>10</sub> <i>K</i>.";
        figure(html, svg, caption);
    }
    if let Some(svg) = &pictures.spectrum_axes {
        let caption = "<i>P</i> at the wave vectors along each axis: the power of the points' projections onto it. A point set \
             that is stratified along an axis has low power there. Each is a single mode, so that it scatters more than a \
             ring.";
        figure(html, svg, caption);
    }
    if let Some(svg) = &pictures.spectrum_angular {
        let caption = "Mean of <i>P</i> over the modes of whole rings whose frequency <b>m</b>/<i>L</i> lies in a sector of \
             directions, over the mean of the ring means at the same modes: 1 for an isotropic spectrum, however steep. \
             Opposite directions are the same.";
        figure(html, svg, caption);
    }
    if let Some(image) = &pictures.spectrum {
        let data = base64::engine::general_purpose::STANDARD.encode(&image.png);
        let picture = format!(
            "<img alt=\"Power spectrum on the frequency grid\" width=\"{}\" height=\"{}\" \
             src=\"data:image/png;base64,{data}\">\n{}",
            image.width,
            image.height,
            color_bar(&image.ticks)
        );
        let caption = format!(
            "{definition} on the frequency grid: {}. Tone map: {}.",
            escape(&image.caption),
            escape(&tone_text())
        );
        figure(html, &picture, &caption);
    }
    if let (Some(image), Some(covariance)) = (&pictures.covariance, a.covariance()) {
        html.push_str("<h2>Covariance of amplitudes</h2>\n");
        let data = base64::engine::general_purpose::STANDARD.encode(&image.png);
        let picture = format!(
            "<img alt=\"Covariance of amplitudes\" width=\"{0}\" height=\"{0}\" src=\"data:image/png;base64,{data}\">\n{1}",
            image.side,
            color_bar(&image.ticks)
        );
        let s = &covariance.scalars;
        let value = |x: Option<f64>| x.map_or("undefined".into(), human);
        let caption = format!(
            "|<i>C<sub>ml</sub></i>| with <i>C<sub>ml</sub></i> = ∑<sub><i>k</i></sub> <i>s</i><sub><b>m</b></sub> \
             <i>s</i><sub><b>l</b></sub><sup>*</sup> / ∑<sub><i>k</i></sub> <i>n<sub>k</sub></i>: {}. Its diagonal is <i>P</i>; \
             off the diagonal the expectation is 0 for a stationary process. Without zero frequency, the share of all \
             |<i>C</i>|<sup>2</sup> off the diagonal is {} (by chance alone {}), the largest |<i>C</i>| there {} standard \
             errors, their root mean square {}.",
            escape(&image.caption),
            human(s.off_diagonal_share),
            value(s.off_diagonal_share_by_chance),
            value(s.largest_z),
            value(s.rms_z)
        );
        figure(html, &picture, &caption);
    }
    if let (Some(svg), Some(neighbors)) = (&pictures.neighbor_functions, a.neighbors()) {
        html.push_str("<h2>Nearest neighbours</h2>\n");
        let edges = if a.domain.is_torus() {
            ""
        } else {
            " Distances longer than the way to the border are censored there (Kaplan-Meier)."
        };
        let caption = format!(
            "<i>G</i>(<i>r</i>): the probability that a point has another closer than <i>r</i>. <i>F</i>(<i>r</i>): that a \
             fixed place has a point closer than <i>r</i>, from a lattice of {} test points. Of independent points both are \
             1 − exp(−<i>λ v r<sup>d</sup></i>), with <i>v</i> the measure of the unit ball; <i>G</i> below <i>F</i> means \
             that points keep apart.{edges}{}",
            neighbors.functions.probes,
            envelope(a, &["neighbor_g", "neighbor_f"])
        );
        figure(html, svg, &caption);
    }
    if let Some(svg) = &pictures.points {
        html.push_str("<h2>Points</h2>\n");
        figure(html, svg, &format!("The {}.", escape(&points_picture::caption(a))));
    }
}

/// What the envelopes of these curves say.
fn envelope(a: &Analysis, names: &[&str]) -> String {
    let Some(e) = a.envelopes() else { return String::new() };
    let mut text = format!(
        " {} simulations of complete spatial randomness with as many points: at one <i>r</i> chosen beforehand, a random \
         pattern leaves their range with probability {}.",
        e.simulations,
        human(e.pointwise_significance())
    );
    for c in e.curves.iter().filter(|c| names.contains(&c.observed.name)) {
        let [lo, hi] = c.p_interval;
        let name = match c.observed.name {
            "g" => "<i>g</i>",
            "g_kernel" => "the smoothed <i>g</i>",
            "k" => "<i>K</i>",
            "l_minus_r" => "<i>L</i> − <i>r</i>",
            "neighbor_g" => "<i>G</i>",
            "neighbor_f" => "<i>F</i>",
            other => other,
        };
        let verdict = if c.p <= c.alpha { "differs from" } else { "agrees with" };
        let _ = write!(
            text,
            " Over all <i>r</i>, {name} {verdict} randomness at the {} % level (global rank envelope test by extreme rank \
             length: <i>p</i> = {}, by extreme rank alone {} to {}).",
            human(100.0 * c.alpha),
            human(c.p),
            human(lo),
            human(hi)
        );
    }
    text
}

/// g(h) as a picture with its scale of colours, and along rings.
fn vector_figures(
    html: &mut String,
    vector: &VectorCorrelation,
    pictures: &Pictures,
    figure: impl Fn(&mut String, &str, &str),
) {
    let gamma = match vector.correction {
        Correction::None => "|<i>D</i>| times its volume",
        _ => "the integral over the cell of the set covariance |<i>D</i> ∩ (<i>D</i> + <b>h</b>)|",
    };
    let pairs = match vector.normalization {
        Normalization::Pairs => "<i>n</i>(<i>n</i> − 1)",
        Normalization::Intensity => "<i>n</i><sup>2</sup>",
    };
    let definition = format!(
        "<i>g</i>(<b>h</b>) = |<i>D</i>|<sup>2</sup> ∑<sub><i>k</i></sub> <i>c<sub>k</sub></i> / (<i>V</i> \
         ∑<sub><i>k</i></sub> {pairs}): <i>c<sub>k</sub></i> ordered pairs of realization <i>k</i> whose lag <b>h</b>, the \
         vector between the points, is in the cell, and <i>V</i> {gamma}"
    );
    if let Some(image) = &pictures.pcf_vector {
        let data = base64::engine::general_purpose::STANDARD.encode(&image.png);
        let stops = (0..=16).map(|k| f64::from(k) / 16.0).map(|x| {
            let [r, g, b] = diverging(x);
            format!("#{r:02x}{g:02x}{b:02x}")
        });
        let stops = stops.collect::<Vec<_>>().join(", ");
        let [low, high] = image.range.map(human);
        let ends = if image.range[0] == 0.0 {
            [low, format!("≥ {high}")]
        } else {
            [format!("≤ {low}"), format!("≥ {high}")]
        };
        let picture = format!(
            "<img alt=\"Pair correlation function on the grid of lags\" width=\"{}\" height=\"{}\" \
             src=\"data:image/png;base64,{data}\">\n<div class=\"scale\"><span style=\"background: linear-gradient(to \
             right, {stops})\"></span><div><i>{}</i><i>g = 1</i><i>{}</i></div></div>",
            image.width, image.height, ends[0], ends[1]
        );
        let caption = format!(
            "{definition}: {}. Colours are clipped at {} and {}, symmetric about 1.",
            escape(&image.caption),
            human(image.range[0]),
            human(image.range[1])
        );
        figure(html, &picture, &caption);
    } else {
        let _ =
            writeln!(html, "<p>{definition}. In one dimension it is <i>g</i>(<i>r</i>) at <i>r</i> = |<i>h</i>|.</p>");
    }
    if let Some(svg) = &pictures.pcf_angular {
        let caption = "The same along rings, by direction: ordered pairs over expected ones in the cells of a finer grid whose \
             centres lie in a ring and a sector. Opposite directions are the same. An isotropic pattern has level lines, up to \
             what <i>g</i> changes from cell to cell: finer cells make that less.";
        figure(html, svg, caption);
    }
}

fn errors(html: &mut String, a: &Analysis) {
    let mut rows: Vec<(String, String)> = Vec::new();
    let across = |what: &str| {
        format!(
            "standard error of {what} across the {} realizations (of a ratio of sums, where <i>n</i> varies)",
            a.shape.realizations
        )
    };
    if let Some(pcf) = a.pair_correlation() {
        let text = match pcf.errors {
            ErrorSource::AcrossRealizations => across("each bin's <i>g</i>"),
            ErrorSource::Theory => "theory, for a single realization: Poisson counts of unordered pairs".into(),
        };
        rows.push(("<i>g</i>(<i>r</i>)".into(), text));
    }
    if let Some(cross) = a.cross() {
        let text = match cross.between.errors {
            ErrorSource::AcrossRealizations => across("each bin's <i>g</i>"),
            ErrorSource::Theory => "theory, for a single realization: Poisson counts of unordered pairs".into(),
        };
        rows.push(("<i>g</i> of two classes".into(), text));
    }
    if let Some(k) = a.k_function() {
        let text = match k.errors {
            ErrorSource::AcrossRealizations => across("<i>K</i>"),
            ErrorSource::Theory => "theory, for a single realization: Poisson counts of unordered pairs, as for \
                                    independent points; edge effects of a window add to it as <i>r</i> grows"
                .into(),
        };
        rows.push(("<i>K</i>(<i>r</i>), <i>L</i>(<i>r</i>)".into(), text));
    }
    if let Some(kernel) = a.kernel() {
        let text = match kernel.errors {
            ErrorSource::AcrossRealizations => across("the estimate at each <i>r</i>"),
            ErrorSource::Theory => {
                "theory, for a single realization: as if all pairs were independent (Poisson)".into()
            }
        };
        rows.push(("kernel estimate".into(), text));
    }
    if let Some(vector) = a.vector() {
        let text = match vector.errors {
            ErrorSource::AcrossRealizations => across("each cell's <i>g</i>, and of each sector's"),
            ErrorSource::Theory => {
                "theory, for a single realization: Poisson counts of unordered pairs, a cell and its mirror image being one"
                    .into()
            }
        };
        rows.push(("<i>g</i>(<b>h</b>)".into(), text));
    }
    if let Some(radial) = a.radial() {
        let text = match radial.errors {
            ErrorSource::AcrossRealizations => across("each ring's mean of <i>P</i>"),
            ErrorSource::Theory => {
                "theory, for a single realization: independent exponential ordinates, <i>P</i> / √(independent modes)"
                    .into()
            }
        };
        rows.push(("<i>P</i>(<i>ν</i>)".into(), text));
        rows.push((
            "anisotropy".into(),
            "theory: the scatter of an isotropic spectrum with the ring's number of independent modes".into(),
        ));
    }
    if let Some(neighbors) = a.neighbors() {
        if neighbors.distances.mean_se.is_some() {
            rows.push(("nearest-neighbour distances, bond order".into(), across("the realization's value")));
        }
        let text = match neighbors.functions.errors {
            ErrorSource::AcrossRealizations => across("each distance's <i>G</i> and <i>F</i>"),
            ErrorSource::Theory => {
                "theory, for a single realization: binomial, as if the distances of all points were independent; for \
                 <i>F</i> as of only as many test points as there are points"
                    .into()
            }
        };
        rows.push(("<i>G</i>(<i>r</i>), <i>F</i>(<i>r</i>)".into(), text));
    }
    if !rows.is_empty() {
        html.push_str("<h2>Error bars</h2>\n<p>All are one standard error.</p>\n");
        table(html, &rows);
    }
}
