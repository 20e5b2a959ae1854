//! The corpus of `fuzz/`, whole, cut short and with bits flipped, through the functions that are fuzzed: none panics, and none takes memory
//! that its bytes do not account for, which the limit of this room's allocator sees.

use std::path::Path;

#[path = "../../fuzz/targets.rs"]
mod targets;

/// A xorshift.
struct Random(u64);

impl Random {
    fn below(&mut self, most: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % most.max(1) as u64) as usize
    }
}

fn corpus(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|path| std::fs::read(path).unwrap()).collect()
}

#[test]
fn every_target_has_a_corpus_and_a_program() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let listed = |folder: &str| {
        let entries = std::fs::read_dir(root.join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = names.map(|name| name.trim_end_matches(".rs").to_string()).collect();
        names.sort();
        names
    };
    let mut targets: Vec<_> = targets::TARGETS.iter().map(|(name, _)| name.to_string()).collect();
    targets.sort();
    assert_eq!(listed("corpus"), targets);
    assert_eq!(listed("fuzz_targets"), targets);
    let manifest = std::fs::read_to_string(root.join("Cargo.toml")).unwrap();
    assert!(targets.iter().all(|name| manifest.contains(&format!("name = \"{name}\""))));
    assert!(targets.iter().all(|name| corpus(name).iter().map(Vec::len).sum::<usize>() < 1 << 15), "small");
}

#[test]
fn the_corpus_is_read_without_panics() {
    const CUTS: usize = 6;
    const FLIPS: usize = 10;
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut inputs = Vec::new();
    for (name, target) in targets::TARGETS {
        for whole in corpus(name) {
            for cut in 1..=CUTS {
                inputs.push((name, target, whole[..whole.len() * cut / CUTS].to_vec()));
            }
            for _ in 0..FLIPS {
                let mut flipped = whole.clone();
                for _ in 0..=random.below(3) {
                    let at = random.below(8 * flipped.len());
                    if let Some(byte) = flipped.get_mut(at / 8) {
                        *byte ^= 1 << (at % 8);
                    }
                }
                inputs.push((name, target, flipped));
            }
        }
    }
    for (name, target, bytes) in &inputs {
        let read = std::panic::catch_unwind(|| target(bytes));
        assert!(read.is_ok(), "{name}: {bytes:?}");
    }
    assert!(inputs.len() > 500, "{}", inputs.len());
}

/// Headers that claim more than any file holds.
#[test]
fn what_a_header_claims_is_not_taken_for_granted() {
    let npy = |shape: &str| crate::shared::npy_f64(shape, 64);
    let ply = |kind: &str| {
        format!(
            "ply\nformat {kind} 1.0\nelement vertex 4000000000000\nproperty double x\nproperty double y\nend_header\n12345678"
        )
    };
    let vtk = |kind: &str| {
        format!("# vtk DataFile Version 3.0\n\n{kind}\nDATASET POLYDATA\nPOINTS 4000000000000 double\n1 2 3\n")
    };
    let inputs: [(&str, Vec<u8>); 12] = [
        ("points_npy", npy("(4000000000000, 2)")),
        ("points_npy", npy("(4000000000000, 1000000, 2)")),
        ("points_raw", crate::shared::utk(5, 1, [u32::MAX, u32::MAX, 2], &[0; 64])),
        ("points_ply", ply("ascii").into()),
        ("points_ply", ply("binary_little_endian").into()),
        ("points_vtk", vtk("ASCII").into()),
        ("points_vtk", vtk("BINARY").into()),
        ("points_xyz", b"4000000000000\n\nH 0.1 0.2 0.3\n".to_vec()),
        ("points_lammps", b"ITEM: NUMBER OF ATOMS\n4000000000000\nITEM: ATOMS x y\n0.1 0.2\n".to_vec()),
        ("pictures", npy("(8000, 8000)")),
        ("pictures", b"PF\n8000 8000\n-1\n0000".to_vec()),
        ("points_text", b"4000000000000\n0.1 0.2\n".to_vec()),
    ];
    for (name, bytes) in inputs {
        targets::run(name, &bytes);
    }
}

/// The corpus changed at random for as long as `PAIRWAVE_FUZZ_SECONDS` says, where there is no cargo-fuzz.
#[test]
#[ignore = "runs until it is told to end"]
fn the_corpus_is_mutated() {
    let seconds = std::env::var("PAIRWAVE_FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(10.0);
    let seed = std::env::var("PAIRWAVE_FUZZ_SEED").ok().and_then(|text| text.parse().ok()).unwrap_or(1u64);
    let wanted = std::env::var("PAIRWAVE_FUZZ_TARGET").unwrap_or_default();
    let targets: Vec<_> = targets::TARGETS.iter().filter(|(name, _)| name.contains(&wanted)).collect();
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let until = std::time::Duration::from_secs_f64(seconds / targets.len() as f64);
    for (name, target) in targets {
        let corpus = corpus(name);
        let (start, mut runs) = (std::time::Instant::now(), 0u64);
        while start.elapsed() < until {
            let bytes = mutated(&corpus, &mut random);
            let began = std::time::Instant::now();
            let read = std::panic::catch_unwind(|| target(&bytes));
            if read.is_err() || began.elapsed().as_secs() > 2 {
                let path = std::env::temp_dir().join(format!("pairwave_{name}_{runs}"));
                std::fs::write(&path, &bytes).unwrap();
                println!("{name}: {} in {:.1} s", path.display(), began.elapsed().as_secs_f64());
            }
            runs += 1;
        }
        println!("{name}: {runs} runs");
    }
}

/// One of the corpus with some of it changed: bits, bytes, words, pieces of another.
fn mutated(corpus: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    const WORDS: [&[u8]; 26] = [
        b"0",
        b"-1",
        b"nan",
        b"inf",
        b"1e999",
        b"4294967295",
        b"9223372036854775808",
        b"18446744073709551616",
        b",",
        b"\n",
        b"\n\n",
        b"\"",
        b" ",
        b"\t",
        b"#",
        b"=",
        b"(",
        b"[",
        b"{",
        b"\0",
        b"\xff\xff\xff\xff",
        b"\x7f\xff\xff\xff",
        b"x",
        b"1.5",
        b";",
        b"'",
    ];
    let mut bytes = corpus[random.below(corpus.len())].clone();
    for _ in 0..=random.below(5) {
        let at = random.below(bytes.len() + 1);
        let most = [1, 4, 16, 64][random.below(4)];
        let end = (at + random.below(1 + most)).min(bytes.len());
        match random.below(8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1 << random.below(8)),
            3 => bytes.iter_mut().skip(at).take(1).for_each(|byte| *byte = random.below(256) as u8),
            4 => drop(bytes.splice(at..end, WORDS[random.below(WORDS.len())].iter().copied())),
            5 => drop(bytes.splice(at..at, WORDS[random.below(WORDS.len())].iter().copied())),
            6 => {
                let other = &corpus[random.below(corpus.len())];
                let from = random.below(other.len() + 1);
                let to = (from + random.below(64)).min(other.len());
                drop(bytes.splice(at..end, other[from..to].iter().copied()));
            }
            _ => {
                let piece = bytes[at..end].to_vec();
                let to = random.below(bytes.len() + 1);
                drop(bytes.splice(to..to, piece));
            }
        }
    }
    bytes
}
