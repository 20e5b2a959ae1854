//! `analyze` end to end: what appears, and that it is the same whatever computed it.

use crate::shared::{Scratch, column, csv, npy, summary};

#[test]
fn without_a_directory_the_main_numbers_are_printed() {
    let scratch = Scratch::new();
    let asked = "analyze --sampler jittered -n 64 -k 4 --stats pcf,k-function,spectrum,neighbors --device cpu";
    let printed = scratch.ok(asked);
    assert_eq!(std::fs::read_dir(scratch.0.path()).unwrap().count(), 0, "nothing is written");
    scratch.ok(&format!("{asked} --out result"));
    // Tables as wide as their cells, the first and the last row among 16, with the numbers of the files.
    for (heading, file, names) in [
        ("pair correlation function", "pcf.csv", "r g g_se"),
        ("Ripley's K function", "k_function.csv", "r k k_se l_se l_minus_r neighbors"),
        ("radial mean of the power spectrum", "spectrum_radial.csv", "nu p p_se anisotropy_db p_lo p_hi"),
        (
            "nearest-neighbour and empty-space functions",
            "neighbor_functions.csv",
            "r g_function g_function_se f_function f_function_se j_function poisson",
        ),
    ] {
        let (_, table) =
            printed.split_once(&format!("\n# {heading}, ")).unwrap_or_else(|| panic!("{heading}: {printed}"));
        let table: Vec<Vec<&str>> =
            table.lines().skip(1).take_while(|l| !l.is_empty()).map(|l| l.split_whitespace().collect()).collect();
        assert_eq!(table[0].join(" "), names);
        assert_eq!(table.len(), 17);
        let whole = csv(&scratch.path("result").join(file));
        for (k, name) in table[0].iter().enumerate() {
            let cells: Vec<String> = column(&whole, name);
            for (row, cell) in [(1, cells.first()), (16, cells.last())] {
                let (printed, whole) = (table[row][k].parse::<f64>(), cell.unwrap().parse::<f64>());
                match (printed, whole) {
                    (Ok(printed), Ok(whole)) => {
                        assert!((printed - whole).abs() <= 5e-4 * whole.abs(), "{name}: {whole}")
                    }
                    _ => assert_eq!((table[row][k], cell.unwrap().as_str()), ("-", "")),
                }
            }
        }
    }
    for said in ["g(r): 256 bins", "Intensity λ ", "64 per unit area", "Effective Nyquist frequency"] {
        assert!(printed.contains(said), "{said}: {printed}");
    }
    assert!(!printed.contains(['<', '\u{2800}']), "no tags, and no plot on a pipe: {printed}");
    let quiet = scratch.ok(&format!("{asked} --quiet"));
    assert!(printed.ends_with(&quiet) && quiet.starts_with("\nPoints per realization n"), "{quiet}");
    let output = scratch.run(&format!("{asked} --force"));
    let errors = String::from_utf8(output.stderr).unwrap();
    let expected = "error: --force (given): needs --out: without it nothing is written\n";
    assert_eq!((output.status.code(), errors.as_str()), (Some(2), expected));
}

/// Wherever a length or a frequency is shown, and nowhere among the columns. What is no XML is escaped.
#[test]
fn the_length_unit_has_the_name_it_is_given() {
    let scratch = Scratch::new();
    let asked =
        "analyze --sampler jittered -n 36 -k 2 --stats pcf,pcf-vector,k-function,spectrum,neighbors --device cpu";
    scratch.ok(&format!("{asked} --out plain --quiet"));
    let printed = scratch.ok(&format!("{asked} --out named --unit <µm>"));
    assert!(printed.contains(" <µm>, mean ") && printed.contains(") <µm>, "), "{printed}");
    let printed = scratch.ok(&format!("{asked} --unit µm"));
    for said in ["r in µm:", "nu in cycles per µm:", " 36 per µm²\n"] {
        assert!(printed.contains(said), "{said}: {printed}");
    }
    for file in std::fs::read_dir(scratch.path("named")).unwrap() {
        let name = file.unwrap().file_name().into_string().unwrap();
        let [plain, named] = ["plain", "named"].map(|dir| std::fs::read(scratch.path(dir).join(&name)).unwrap());
        if !name.ends_with("svg") && !name.ends_with("html") {
            assert_eq!(plain == named, !["summary.json", "run.toml"].contains(&name.as_str()), "{name}");
            continue;
        }
        let [plain, named] = [plain, named].map(|text| String::from_utf8(text).unwrap());
        assert!(!named.contains("length unit") && !named.contains("unit length"), "{name}");
        // Directions alone have no unit; nothing else has none.
        assert_eq!(
            named.contains("&lt;µm&gt;"),
            plain.contains("length unit") || plain.contains("unit length"),
            "{name}"
        );
        if name.ends_with("svg") {
            roxmltree::Document::parse(&named).unwrap();
        }
    }
    assert_eq!(summary(&scratch.path("named"))["parameters"]["unit"], "<µm>");
    let output = scratch.command().args(asked.split(' ')).args(["--unit", " "]).output().unwrap();
    let errors = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(errors.contains("--unit <NAME>': expected the name of a length unit, such as m or µm"), "{errors}");
}

#[test]
fn analyze_writes_what_it_promises() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler jittered -n 64 -k 20 --seed 3 --kernel epanechnikov --device cpu --out result");
    let dir = scratch.path("result");
    let mut files: Vec<_> =
        std::fs::read_dir(&dir).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
    files.sort();
    let expected = [
        "anisotropy.svg",
        "neighbor_functions.csv",
        "neighbor_functions.svg",
        "pcf.csv",
        "pcf.svg",
        "pcf_from_spectrum.csv",
        "points.svg",
        "report.html",
        "run.toml",
        "spectrum.npy",
        "spectrum.png",
        "spectrum_angular.csv",
        "spectrum_angular.svg",
        "spectrum_axes.csv",
        "spectrum_axes.svg",
        "spectrum_from_pcf.csv",
        "spectrum_grey.png",
        "spectrum_radial.csv",
        "spectrum_radial.svg",
        "spectrum_se.npy",
        "summary.json",
    ];
    assert_eq!(files, expected);

    let pcf = csv(&dir.join("pcf.csv"));
    assert_eq!(pcf.0, "r_lo,r,r_hi,count,g,g_se,g_kernel,g_kernel_se");
    assert_eq!(pcf.1.len(), 256);
    let (lo, r, hi): (Vec<f64>, Vec<f64>, Vec<f64>) = (column(&pcf, "r_lo"), column(&pcf, "r"), column(&pcf, "r_hi"));
    assert!(lo.iter().zip(&r).zip(&hi).all(|((lo, r), hi)| lo < r && r < hi) && lo[1..] == hi[..255]);
    assert_eq!(hi[255], 0.5, "8 closest-packing distances of 64 points exceed half the torus");
    let (count, g): (Vec<u64>, Vec<f64>) = (column(&pcf, "count"), column(&pcf, "g"));
    let ring = std::f64::consts::PI * (hi[200] * hi[200] - lo[200] * lo[200]);
    assert!((g[200] - count[200] as f64 / (20.0 * 64.0 * 63.0 * ring)).abs() < 1e-12);

    let (shape, p) = npy(&dir.join("spectrum.npy"));
    assert_eq!(shape, [81, 81], "F = ceil(5 sqrt(64)) = 40");
    assert_eq!(p[40 * 81 + 40], 64.0, "DC is n");
    assert!(p.iter().eq(p.iter().rev()), "P(-m) = P(m)");
    assert_eq!(npy(&dir.join("spectrum_se.npy")).0, shape);

    let radial = csv(&dir.join("spectrum_radial.csv"));
    let named = "nu_lo,nu,nu_hi,modes,p,p_se,anisotropy_db,anisotropy_reference_db";
    assert!(radial.0.starts_with(named), "{}", radial.0);
    assert_eq!(radial.1.len(), 40);
    assert_eq!(column::<u64>(&radial, "modes")[0], 8, "DC is in no ring");
    let mean = (0..81 * 81)
        .filter(|i| {
            let (a, b) = (i / 81 - 40, i % 81 - 40);
            let m = f64::from(a * a + b * b).sqrt();
            (4.5..5.5).contains(&m)
        })
        .map(|i| p[i as usize])
        .sum::<f64>()
        / column::<f64>(&radial, "modes")[4];
    assert!((column::<f64>(&radial, "p")[4] - mean).abs() < 1e-9);

    let json = summary(&dir);
    let text = json.to_string();
    for fact in ["\"cpu\"", "across-realizations", "jittered"] {
        assert!(text.contains(fact), "summary.json lacks {fact}: {text}");
    }
    let html = std::fs::read_to_string(dir.join("report.html")).unwrap();
    assert!(!html.contains("src=\"http") && !html.contains("href=\"http"), "the page is self-contained");
}

#[test]
fn the_same_request_gives_the_same_bytes_on_any_number_of_threads() {
    let scratch = Scratch::new();
    for threads in [1, 2, 3] {
        scratch.ok(&format!("analyze --sampler thomas -n 80 -k 35 --device cpu --threads {threads} --out t{threads}"));
    }
    for file in ["pcf.csv", "spectrum_radial.csv", "spectrum.npy", "spectrum_se.npy"] {
        let bytes = |t: u32| std::fs::read(scratch.path(&format!("t{t}")).join(file)).unwrap();
        assert!(bytes(1) == bytes(2) && bytes(1) == bytes(3), "{file}");
    }
}

#[test]
fn a_sampled_file_gives_what_the_sampler_gives() {
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 50 -k 5 --seed 9 --device cpu --out direct");
    for format in ["csv", "txt", "npy", "npz", "bin"] {
        scratch.ok(&format!("sample random -n 50 -k 5 --seed 9 --out points.{format}"));
        scratch.ok(&format!("analyze points.{format} --device cpu --out {format}"));
        for file in ["pcf.csv", "spectrum_radial.csv", "spectrum.npy"] {
            let bytes = |d: &str| std::fs::read(scratch.path(d).join(file)).unwrap();
            assert!(bytes("direct") == bytes(format), "{file} by way of {format}");
        }
    }
}

#[test]
fn many_small_realizations_stay_within_memory() {
    // 2000 spectra of 64 x 161^2 would be 400 MB; the plan holds a few at a time. Here: it finishes, and P is right.
    let scratch = Scratch::new();
    scratch.ok("analyze --sampler random -n 64 -k 2000 --device cpu --stats spectrum --out many");
    let radial = csv(&scratch.path("many/spectrum_radial.csv"));
    for (p, se) in column::<f64>(&radial, "p").iter().zip(column::<f64>(&radial, "p_se")) {
        assert!((p - 1.0).abs() < 6.0 * se, "P = {p} +- {se}");
    }
}

#[test]
fn explain_prints_the_plan_and_computes_nothing() {
    let scratch = Scratch::new();
    let plan = scratch.ok("analyze --sampler random -n 100000 -k 100 --stats pcf --device cpu --explain");
    for fact in ["pair_counts", "256 bins", "skipped: spectrum (not asked for)", "device: "] {
        assert!(plan.contains(fact), "{fact} is missing from\n{plan}");
    }
}

#[test]
fn quiet_is_silent_and_stdin_is_a_file() {
    let scratch = Scratch::new();
    let output = scratch
        .command()
        .args(["analyze", "-", "--device", "cpu", "--quiet", "--out", "o"])
        .write_stdin("0.1 0.2\n0.3 0.4\n# next\n0.5 0.5\n0.6 0.7\n")
        .output()
        .unwrap();
    assert!(output.status.success() && output.stdout.is_empty() && output.stderr.is_empty(), "{output:?}");
    assert!(std::fs::read_to_string(scratch.path("o/summary.json")).unwrap().contains("2"));
}

/// Errors of g and K know of clusters; those of other sums of pairs do not, and say so.
#[test]
fn clusters_of_a_single_realization_are_named() {
    let scratch = Scratch::new();
    let errors = |flags: &str| {
        scratch.ok(&format!("analyze --sampler {flags} --stats pcf --device cpu --force --out out"));
        let summary = summary(&scratch.path("out"));
        (
            summary["pair_correlation"]["errors"].clone(),
            summary["warnings"].to_string().contains("points are clustered: "),
        )
    };
    assert_eq!(errors("thomas -n 500"), ("cluster-theory".into(), false));
    assert_eq!(errors("thomas -n 500 --kernel epanechnikov"), ("cluster-theory".into(), true));
    assert_eq!(errors("thomas -n 500 -k 2 --kernel epanechnikov"), ("across-realizations".into(), false));
    for seed in 1..20 {
        assert_eq!(errors(&format!("random -n 500 --seed {seed}")), ("spectral-theory".into(), false), "{seed}");
    }
    for regular in ["jittered -n 484", "grid -n 484", "poisson-disk -n 484"] {
        assert_eq!(errors(regular), ("spectral-theory".into(), false), "{regular}");
    }
}

/// What the CPU path has done before a GPU is ready is done by it, and said to be; where a device is named, nobody looks at how long it takes.
#[test]
fn no_gpu_is_looked_for_where_there_is_little_to_do() {
    let scratch = Scratch::new();
    let notes = |arguments: &str| {
        let output = scratch.run(arguments);
        assert!(output.status.success(), "{arguments}");
        String::from_utf8(output.stderr).unwrap()
    };
    let few = "analyze --sampler random -n 64 --explain";
    assert!(notes(few).contains("less than a GPU takes to be ready"), "{}", notes(few));
    assert!(!notes("analyze --sampler random -n 4000 -k 4000 --explain").contains("less than a GPU takes"));
    assert!(!notes(&format!("{few} --device cpu")).contains("a GPU"));
}
