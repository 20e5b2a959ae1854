//! Every folder of `src/` uses only those below it. Read from the paths in the code; cannot see what is used through a method alone.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The folders and files of `src/`, from the ground up: the order of the README's map.
pub const FLOORS: [&str; 31] = [
    "setting",
    "named",
    "sinc",
    "fourier",
    "ball",
    "error",
    "control",
    "pool",
    "memory",
    "input",
    "stage",
    "points",
    "samplers",
    "integrand",
    "plan",
    "accumulate",
    "estimate",
    "request",
    "source",
    "compute",
    "selftest",
    "display",
    "statistics",
    "report",
    "analysis",
    "survey",
    "convergence",
    "prediction",
    "comparison",
    "benchmark",
    "command",
];

/// Who uses what above it, and why that stands.
const EXCEPTIONS: [(&str, &str, &str); 0] = [];

/// Files of Rust in a folder, all levels deep.
fn files(folder: &Path, into: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs") {
            into.push(path);
        }
    }
}

/// What a text uses of the crate: `points` of `crate::points::Domain` and of `crate::{points, plan}`. Neither comments nor tests.
fn used(text: &str, crate_name: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]").next().unwrap();
    let code: String = code.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join(" ");
    let word = |s: &str| s.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut names = BTreeSet::new();
    for rest in code.split(&format!("{crate_name}::")).skip(1) {
        let Some(group) = rest.strip_prefix('{') else {
            names.insert(word(rest));
            continue;
        };
        // What a part of a group leads to stands in braces of its own.
        let mut depth = 1;
        let mut flat = String::new();
        for c in group.chars() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            match depth {
                0 => break,
                1 => flat.push(c),
                _ => {}
            }
        }
        names.extend(flat.split(',').map(|part| word(part.trim())).filter(|name| !name.is_empty()));
    }
    names
}

/// The uses of the tree: which file of which floor uses which floor.
fn uses() -> Vec<(String, &'static str, &'static str)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    // What stands at the root of the crate belongs to a floor as well.
    let root = std::fs::read_to_string(src.join("lib.rs")).unwrap();
    let mut homes: BTreeMap<String, String> = FLOORS.iter().map(|f| (f.to_string(), f.to_string())).collect();
    for line in root.split("\npub use ").skip(1) {
        let (path, names) = line.split(';').next().unwrap().split_once("::").unwrap();
        for name in names.trim_matches(['{', '}']).split(',') {
            homes.insert(name.rsplit("::").next().unwrap().trim().into(), path.into());
        }
    }
    let floor = |name: &str| {
        let home = homes.get(name)?;
        FLOORS.into_iter().find(|f| f == home)
    };
    let mut all = Vec::new();
    files(&src, &mut all);
    let mut found = Vec::new();
    for path in all {
        let file = path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
        let first = file.split('/').next().unwrap().trim_end_matches(".rs");
        let Some(user) = floor(first) else {
            assert!(["lib", "main"].contains(&first), "{file} is on no floor");
            continue;
        };
        let text = std::fs::read_to_string(&path).unwrap();
        let crate_name = if user == "command" { "pairwave" } else { "crate" };
        for name in used(&text, crate_name) {
            match floor(&name) {
                Some(other) if other != user => found.push((file.clone(), user, other)),
                _ => {}
            }
        }
    }
    found
}

/// A circle among floors, if there is one.
fn circle(graph: &BTreeMap<&str, BTreeSet<&str>>) -> Option<String> {
    fn walk<'a>(at: &'a str, graph: &BTreeMap<&'a str, BTreeSet<&'a str>>, path: &mut Vec<&'a str>) -> Option<String> {
        if let Some(start) = path.iter().position(|f| *f == at) {
            return Some([&path[start..], &[at]].concat().join(" -> "));
        }
        path.push(at);
        let found = graph.get(at).into_iter().flatten().find_map(|next| walk(next, graph, path));
        path.pop();
        found
    }
    graph.keys().find_map(|start| walk(start, graph, &mut Vec::new()))
}

#[test]
fn there_is_no_circle_and_every_floor_stands_on_lower_ones() {
    let all = uses();
    let excepted = |file: &str, other: &str| EXCEPTIONS.iter().any(|(f, o, _)| (*f, *o) == (file, other));
    for (file, other, why) in EXCEPTIONS {
        assert!(all.iter().any(|(f, _, o)| (f.as_str(), *o) == (file, other)), "no exception any more: {file}, {why}");
    }
    let mut graph = BTreeMap::<&str, BTreeSet<&str>>::new();
    for (file, user, other) in &all {
        if !excepted(file, other) {
            graph.entry(user).or_default().insert(other);
        }
    }
    assert_eq!(circle(&graph), None);
    let height = |floor: &str| FLOORS.iter().position(|f| *f == floor).unwrap();
    let upward: Vec<_> =
        all.iter().filter(|(f, user, other)| !excepted(f, other) && height(user) < height(other)).collect();
    assert!(upward.is_empty(), "above them: {upward:?}");
    // The paths are really found.
    let expects = [("compute", "accumulate"), ("command", "analysis"), ("error", "setting"), ("report", "error")];
    for (user, other) in expects {
        assert!(graph[user].contains(other), "{user} uses {other}");
    }
}

#[test]
fn a_planted_circle_is_seen() {
    let text = "use crate::points::Domain;\nuse crate::{plan::{Pairs, Waves}, Error};\n// crate::report\n#[cfg(test)] crate::display";
    assert_eq!(used(text, "crate"), ["Error", "plan", "points"].map(String::from).into());
    let graph = [("a", vec!["b"]), ("b", vec!["c", "d"]), ("d", vec!["b"])];
    let graph = graph.into_iter().map(|(from, to)| (from, to.into_iter().collect())).collect();
    assert_eq!(circle(&graph), Some("b -> d -> b".into()));
}
