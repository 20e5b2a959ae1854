//! What is there to choose from, and what it makes.

use crate::shared::{Scratch, summary};

#[test]
fn samplers_and_devices_are_listed() {
    let scratch = Scratch::new();
    let list = scratch.ok("samplers");
    let json: serde_json::Value = serde_json::from_str(&scratch.ok("samplers --json")).unwrap();
    let all = json.as_array().unwrap();
    assert!(all.len() > 30);
    for sampler in all {
        let name = sampler["name"].as_str().unwrap();
        assert!(list.contains(&format!("  {name} ")), "{name} is missing from\n{list}");
        let explained = scratch.ok(&format!("samplers {name}"));
        for parameter in sampler["parameters"].as_array().unwrap() {
            let key = parameter["name"].as_str().unwrap();
            assert!(explained.contains(&format!("--param   {key}=")), "{key} is missing from\n{explained}");
        }
        assert!(sampler["fixed_n"].is_boolean() && sampler["dims"].is_array(), "{sampler}");
    }
    assert!(scratch.ok("samplers mpd").starts_with("maximal-poisson-disk: "), "by an alias");
    assert!(scratch.ok("samplers sobol").contains("Frances Y. Kuo and Stephen Joe"));
    assert!(scratch.ok("devices").starts_with("cpu "));
}

#[test]
fn integrands_are_listed_explained_and_drawn() {
    let scratch = Scratch::new();
    let list = scratch.ok("integrands");
    let json: serde_json::Value = serde_json::from_str(&scratch.ok("integrands --json")).unwrap();
    for integrand in json.as_array().unwrap() {
        let name = integrand["name"].as_str().unwrap();
        assert!(list.contains(&format!("  {name} ")), "{name} is missing from\n{list}");
        let explained = scratch.ok(&format!("integrands {name}"));
        for parameter in integrand["parameters"].as_array().unwrap() {
            let key = parameter["name"].as_str().unwrap();
            assert!(explained.contains(&format!("with      {key}")), "{key} is missing from\n{explained}");
        }
        let needs_file = ["image", "table"].contains(&name);
        assert_eq!(integrand["values"]["variance"].as_f64().is_none_or(|v| v <= 0.0), needs_file, "{integrand}");
    }
    let explained = scratch.ok("integrands ball:r=0.3 --dim 3");
    assert!(
        explained.contains("disk:r=0.3,x=0.5,y=0.5,z=0.5 in 3D\n  integral          0.1130973355292"),
        "{explained}"
    );
    // A picture of each, and none is replaced unasked.
    for (dim, count) in [("", 15), (" --dim 1", 14), (" --dim 3", 13)] {
        let said = scratch.ok(&format!("integrands --draw pictures --force{dim}"));
        assert_eq!(said.lines().count(), count, "{said}");
        for file in said.lines() {
            let svg = std::fs::read_to_string(scratch.path(file)).unwrap();
            assert!(roxmltree::Document::parse(&svg).is_ok() && !svg.contains("NaN"), "{file}");
        }
    }
    let run = scratch.run("integrands disk:r=0.1 --draw pictures");
    assert!(!run.status.success() && String::from_utf8(run.stderr).unwrap().contains("disk.svg"));
    for (arguments, message) in [
        ("dsik", "error: --integrand dsik: no such integrand (did you mean disk?)"),
        ("disk:r=2", "error: --integrand disk:r=2: r=2: r of disk is a number above 0"),
        ("image --draw nothing", "error: --integrand image: has nothing to draw; expected image:file=PATH"),
        ("interval --dim 2", "error: --integrand interval: interval is there in 1D, this is 2D"),
    ] {
        let run = scratch.run(&format!("integrands {arguments}"));
        let said = String::from_utf8(run.stderr).unwrap();
        assert!(run.status.code() == Some(2) && said.starts_with(message), "{arguments}: {said}");
    }
}

#[test]
fn samples_are_written_in_order_by_any_number_of_threads() {
    let scratch = Scratch::new();
    for name in ["thomas", "sobol", "poisson-disk"] {
        let write = |threads: u32, k: u32| {
            scratch.ok(&format!("sample {name} -n 200 -k {k} --threads {threads} --out {name}-{threads}-{k}.csv"));
            std::fs::read_to_string(scratch.path(&format!("{name}-{threads}-{k}.csv"))).unwrap()
        };
        let one = write(1, 40);
        assert_eq!(one, write(2, 40), "{name}");
        assert!(one.starts_with(&write(1, 13)), "{name}: fewer realizations are the first ones");
    }
}

#[test]
fn the_nearest_number_is_taken_and_said() {
    let scratch = Scratch::new();
    let run = scratch.run("sample hexagonal -n 1024 --nearest --out hex.csv");
    assert!(run.status.success());
    assert_eq!(String::from_utf8(run.stderr).unwrap(), "note: n = 1020, the nearest to 1024 that hexagonal can make\n");
    assert_eq!(String::from_utf8(run.stdout).unwrap(), "hex.csv: 1 realization of hexagonal, n = 1020\n");
    // Of two that are as near, the larger: 2.5^2 lies between 4 and 9.
    let run = scratch.run("sample cell -n 30 --nearest -k 2 --out cell.csv");
    assert!(String::from_utf8(run.stderr).unwrap().contains("n = 25,"));
}

#[test]
fn sequences_go_to_sixteen_dimensions() {
    let scratch = Scratch::new();
    for name in ["random", "lhs", "halton", "sobol", "kronecker"] {
        scratch.ok(&format!("sample {name} -n 16 --dim 16 --out {name}.npy"));
        let (shape, values) = crate::shared::npy(&scratch.path(&format!("{name}.npy")));
        assert_eq!(shape, [16, 16]);
        assert!(values.iter().all(|x| (0.0..1.0).contains(x)));
    }
}

/// Where n is drawn, a sampler and a file of its points have the same frequencies by default.
#[test]
fn a_sampler_and_its_file_are_measured_alike() {
    let scratch = Scratch::new();
    let sampler = "thomas -n 90 -k 7 --seed 4";
    scratch.ok(&format!("sample {sampler} --out points.npz"));
    scratch.ok(&format!("analyze --sampler {sampler} --stats pcf,radial --device cpu --out drawn"));
    scratch.ok("analyze points.npz --stats pcf,radial --device cpu --out read");
    for file in ["pcf.csv", "spectrum_radial.csv"] {
        let [drawn, read] = ["drawn", "read"].map(|dir| std::fs::read(scratch.path(dir).join(file)).unwrap());
        let columns = |bytes: &[u8]| -> Vec<String> {
            let text = String::from_utf8(bytes.to_vec()).unwrap();
            let head: Vec<&str> = text.lines().next().unwrap().split(',').collect();
            let keep: Vec<usize> = (0..head.len()).filter(|k| !head[*k].contains("theory")).collect();
            text.lines()
                .map(|l| keep.iter().map(|k| l.split(',').nth(*k).unwrap()).collect::<Vec<_>>().join(","))
                .collect()
        };
        assert_eq!(columns(&drawn), columns(&read), "{file}");
    }
    assert_eq!(summary(&scratch.path("drawn"))["points"], summary(&scratch.path("read"))["points"]);
}

#[test]
fn what_cannot_be_drawn_says_what_can() {
    let scratch = Scratch::new();
    for (arguments, code, message) in [
        ("lattice -n 10 --param a=10", 2, "--param a=10: a of lattice is a whole number from 1 to n - 1 = 9"),
        (
            "matern-ii -n 100 --param radius=0.6",
            2,
            "--param radius=0.6: radius of matern-ii in 2D is below 0.525: no density",
        ),
        ("stealthy -n 100 --param nu0=2", 2, "--param nu0=2: constrains "),
        (
            "stealthy -n 100 --param iterations=2",
            2,
            "--param iterations=2: stealthy points did not converge: the largest P",
        ),
        (
            "lgcp -n 100 --param cells=65",
            2,
            "--param cells=65: cells of lgcp is a power of 2; the nearest are 64 and 128",
        ),
        ("ginibre -n 4000", 2, "-n 4000: ginibre in 2D needs n = 4 to 2048; the nearest is 2048"),
        ("fcc -n 32", 2, "--dim 2: fcc is there in 3 dimensions only"),
        ("halton -n 32 --dim 17", 2, "--dim 17: halton: expected 1 to 16"),
        ("jittered -n 9 --threads 0", 2, "--threads 0: expected 1 to 4096"),
        ("jitered -n 9", 2, "--sampler jitered: no such sampler (did you mean jittered?)"),
        ("thomas -n 9 --param mu=0", 2, "--param mu=0: mu of thomas is a number from 0.01 to 1000000 (default 10)"),
    ] {
        let run = scratch.run(&format!("sample {arguments} --out x.csv"));
        let said = String::from_utf8(run.stderr).unwrap();
        assert_eq!(run.status.code(), Some(code), "{arguments}: {said}");
        assert!(said.starts_with(&format!("error: {message}")), "{arguments}: {said}");
        assert!(!scratch.path("x.csv").exists());
    }
}

#[test]
fn devices_measure_what_closed_forms_say() {
    let scratch = Scratch::new();
    let json: serde_json::Value = serde_json::from_str(&scratch.ok("selftest --device cpu --json")).unwrap();
    let checks = json["checks"].as_array().unwrap();
    assert!(checks.len() > 30 && checks.iter().all(|check| check["holds"] == true), "{json:#}");
}

#[test]
fn shells_complete_names() {
    let scratch = Scratch::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = scratch.ok(&format!("completions {shell}"));
        for word in ["max-frequency", "poisson-disk", "half-plane", "integrate"] {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
    }
    scratch.fails("completions tcsh", 2, "tcsh");
}

#[test]
fn promises_hold_where_they_are_pushed_at() {
    let scratch = Scratch::new();
    let json: serde_json::Value = serde_json::from_str(&scratch.ok("selftest --stress --device cpu --json")).unwrap();
    let all = json["stress"].as_array().unwrap();
    assert!(all.len() > 30 && all.iter().all(|one| one["holds"] == true), "{json:#}");
    // A bound that nothing comes near proves little: of each accuracy one way is within a factor of a thousand.
    for accuracy in ["fast", "high"] {
        let near = |one: &serde_json::Value| {
            let searched = one["what"].as_str().unwrap();
            searched.contains("a search finds")
                && searched.ends_with(accuracy)
                && one["measured"].as_f64().unwrap() > 1e-3 * one["bound"].as_f64().unwrap()
        };
        assert!(all.iter().any(near), "{accuracy}: {json:#}");
    }
}
