//! Random programs, points and settings, whose answers must agree however they are computed: by any device, in parts, in any order of points, with
//! points shifted, turned and mirrored, in a box that is scaled or moved. Nothing is compared with what is known of the points.
//!
//! Coordinates are multiples of 2^-40 and what is done to them is exact, so that counts are equal and P is equal within the promise.

use std::sync::Arc;

use crate::common::*;
use pairwave::analysis::{Measurement, Plan};
use pairwave::compute::{Device, cpu::Cpu, reference::Reference};
use pairwave::control::Control;
use pairwave::plan::{Accuracy, WaveGrid};
use pairwave::points::Domain;
use pairwave::request::DeviceChoice;
use pairwave::samplers::Process;
use pairwave::source::Points;

/// Points in a box, and how they are looked at. Lengths are fractions of the shortest side.
#[derive(Clone)]
struct Program {
    name: String,
    sets: Vec<Vec<f64>>,
    corner: Vec<f64>,
    sides: Vec<f64>,
    r_max: f64,
    bins: String,
    frequency: u32,
    accuracy: Accuracy,
}

/// What comes out.
struct Answer {
    counts: Vec<u64>,
    power: Vec<f64>,
    grid: WaveGrid,
    nearest: f64,
    /// All of it in words: what is undefined is not equal to itself.
    said: String,
}

const STEP: f64 = 1.0 / (1u64 << 40) as f64;

impl Program {
    /// Program number `seed`.
    fn random(seed: u64) -> Self {
        let mut rng = Rng(seed);
        let mut below = |most: u64| rng.bits() % most;
        let dim = 1 + below(3) as usize;
        let samplers: &[&str] = match dim {
            1 => &["random", "jittered", "grid", "thomas"],
            2 => &["random", "jittered", "grid", "lhs", "kronecker", "thomas", "poisson-disk", "cmj"],
            _ => &["random", "jittered", "grid", "lhs", "fcc"],
        };
        let sampler = samplers[below(samplers.len() as u64) as usize];
        let side = [4 + below(40), 3 + below(7), 2 + below(3)][dim - 1];
        let n = if sampler == "fcc" { 4 * side.pow(3) } else { side.pow(dim as u32) };
        let k = [1, 2, 16, 19, 33][below(5) as usize];
        let process = Process::new(sampler, n, k, dim, seed, &[]).unwrap();
        let sides: Vec<f64> = (0..dim).map(|_| [1.0, 1.0, 0.5, 2.0][below(4) as usize]).collect();
        let set = |index| {
            let coordinates = process.coordinates(index, &Control::default()).unwrap();
            coordinates.iter().enumerate().map(|(c, x)| (x / STEP).floor() * STEP * sides[c % dim]).collect()
        };
        let mut sets: Vec<Vec<f64>> = (0..k).map(set).collect();
        // Clusters may be none.
        if sets[0].len() < 2 * dim {
            sets[0] = (0..4 * dim).map(|c| (c as f64 + 0.5) / 16.0 * sides[c % dim]).collect();
        }
        let r_max = [0.45, 0.25, 0.1][below(3) as usize];
        let bins = match below(3) {
            0 => format!("--bins {}", 1 + below(300)),
            1 => format!("--bin-scale log --bins {}", 1 + below(60)),
            _ => "--bins 7".into(),
        };
        let frequency = [40, 9, 4][dim - 1] - below(3) as u32;
        let accuracy = [Accuracy::Fast, Accuracy::High][below(2) as usize];
        let name = format!("program {seed}: {sampler}, {dim}D, n = {n}, K = {k}, sides {sides:?}, {bins}, {accuracy}");
        Self { name, sets, corner: vec![0.0; dim], sides, r_max, bins, frequency, accuracy }
    }

    fn dim(&self) -> usize {
        self.sides.len()
    }

    fn shortest(&self) -> f64 {
        self.sides.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn measurement(&self, device: &Device) -> Measurement {
        let ranges: Vec<_> = self.corner.iter().zip(&self.sides).map(|(&x, side)| (x, x + side)).collect();
        let points = Arc::new(Points::new(Domain::torus_at(&ranges).unwrap(), &self.sets).unwrap());
        let (r_max, bins, f) = (self.r_max * self.shortest(), &self.bins, self.frequency);
        let line = "--sampler random -n 2 -k 1 --stats pcf,spectrum,neighbors --normalization intensity";
        let request =
            request(&format!("{line} --r-max {r_max} {bins} --max-frequency {f} --accuracy {}", self.accuracy));
        let plan = Plan::of(&request, &points).unwrap().for_device(device.compute());
        Measurement::new(request, points, plan)
    }

    fn answer(&self, device: &Device) -> Answer {
        self.finished(self.measurement(device), device)
    }

    fn finished(&self, mut measurement: Measurement, device: &Device) -> Answer {
        while measurement.step(device, &Control::default()).unwrap() {}
        let found = measurement.analysis().unwrap();
        let (spectrum, grid) = found.grid_of_power().unwrap();
        Answer {
            counts: found.pair_correlation().map_or(Vec::new(), |g| g.count.clone()),
            power: spectrum.p.clone(),
            grid: *grid,
            nearest: found.neighbors().and_then(|near| near.distances.mean).unwrap_or(f64::NAN) / self.shortest(),
            said: format!("{:?} {:?} {:?}", found.pair_correlation(), found.spectrum(), found.neighbors()),
        }
    }

    /// The same with every coordinate changed, as a fraction of its side; sides stay.
    fn moved(&self, change: impl Fn(usize, f64) -> f64) -> Self {
        let dim = self.dim();
        let of = |(c, x): (usize, &f64)| change(c % dim, x / self.sides[c % dim]).rem_euclid(1.0) * self.sides[c % dim];
        Self { sets: self.sets.iter().map(|set| set.iter().enumerate().map(of).collect()).collect(), ..self.clone() }
    }
}

/// Whether two answers agree, where mode m of the first is `turned(m)` of the second.
fn differ(program: &Program, a: &Answer, b: &Answer, turned: impl Fn([i32; 3]) -> [i32; 3]) -> Option<String> {
    if a.counts != b.counts {
        return Some(format!("counts {:?} and {:?}", a.counts, b.counts));
    }
    let n = program.sets.iter().map(|set| set.len() / program.dim()).max().unwrap_or(0);
    // Either may be off by the bound.
    let bound = 2.0 * program.accuracy.power_bound().max_any(n as f64);
    for (index, p) in a.power.iter().enumerate() {
        let m = a.grid.mode(index);
        let q = b.power[b.grid.half_index(turned(m))];
        if (p - q).abs() > bound * (1.0 + p) {
            return Some(format!("P of {m:?}: {p} and {q}"));
        }
    }
    // Lengths are rounded to f64 once or twice.
    let off = (a.nearest - b.nearest).abs();
    let apart = a.nearest.is_nan() != b.nearest.is_nan() || off > 1e-12 * a.nearest.abs();
    apart.then(|| format!("nearest neighbours at {} and {}", a.nearest, b.nearest))
}

fn same(m: [i32; 3]) -> [i32; 3] {
    m
}

fn assert_agree(program: &Program, what: &str, a: &Answer, b: &Answer, turned: impl Fn([i32; 3]) -> [i32; 3]) {
    if let Some(why) = differ(program, a, b, turned) {
        panic!("{}: {what}: {why}", program.name);
    }
}

const PROGRAMS: u64 = 40;

fn cpu(threads: usize) -> Device {
    Device::new(Box::new(Cpu::new(Some(threads)).unwrap()), None).unwrap()
}

#[test]
fn answers_do_not_depend_on_who_computes_them() {
    let (one, three) = (cpu(1), cpu(3));
    let reference = Device::new(Box::new(Reference), Some(1)).unwrap();
    let gpu = (!gpu_tests_skipped("metamorphic")).then(|| wait(Device::open(DeviceChoice::Gpu, Some(1))).unwrap());
    for seed in 0..PROGRAMS {
        let program = Program::random(seed);
        let answer = program.answer(&one);
        assert!(answer.said == program.answer(&three).said, "{}: threads change it", program.name);
        assert_agree(&program, "the reference", &answer, &program.answer(&reference), same);
        if let Some(gpu) = gpu.as_ref().filter(|_| seed % 8 == 0) {
            assert_agree(&program, "the GPU", &answer, &program.answer(gpu), same);
        }
        let other = [Accuracy::High, Accuracy::Fast][usize::from(program.accuracy == Accuracy::High)];
        let of_other = Program { accuracy: other, ..program.clone() }.answer(&one);
        let loose = Program { accuracy: Accuracy::Fast, ..program.clone() };
        assert_agree(&loose, "the other accuracy", &answer, &of_other, same);
    }
}

#[test]
fn answers_do_not_depend_on_the_cut() {
    let device = cpu(2);
    for seed in 0..PROGRAMS {
        let program = Program::random(seed);
        let whole = program.answer(&device);
        let k = program.sets.len() as u64;
        let cut = 16 * (k / 32).max(1);
        if cut >= k {
            continue;
        }
        let part = |span: std::ops::Range<u64>| {
            let mut part = program.measurement(&device).within(span, &device).unwrap();
            while part.step(&device, &Control::default()).unwrap() {}
            Measurement::read("part", &part.write()).unwrap()
        };
        // The later part first.
        let mut merged = part(cut..k);
        merged.merge(part(0..cut)).unwrap();
        let merged = program.finished(merged.to(0..k), &device);
        assert!(whole.said == merged.said, "{}: parts cut at {cut} are not the whole", program.name);
    }
}

#[test]
fn answers_do_not_depend_on_the_order_or_the_place_of_points() {
    let device = cpu(1);
    for seed in 0..PROGRAMS {
        let program = Program::random(seed);
        let (dim, answer) = (program.dim(), program.answer(&device));
        let mut reversed = program.clone();
        for set in &mut reversed.sets {
            *set = set.chunks_exact(dim).rev().flatten().copied().collect();
        }
        assert_agree(&program, "points in reverse", &answer, &reversed.answer(&device), same);

        let shift = [0.375, STEP * 3_141_592_653.0, 1.0 - STEP];
        let shifted = program.moved(|axis, x| x + shift[axis]);
        assert_agree(&program, "points shifted", &answer, &shifted.answer(&device), same);

        let mirrored = program.moved(|axis, x| if axis == 0 { -x } else { x });
        assert_agree(&program, "a mirror", &answer, &mirrored.answer(&device), |[x, y, z]| [-x, y, z]);

        if dim > 1 {
            // A quarter turn: (x, y) to (-y, x).
            let mut turned = program.moved(|axis, x| if axis == 1 { -x } else { x });
            turned.sides.swap(0, 1);
            turned.sets.iter_mut().for_each(|set| set.chunks_exact_mut(dim).for_each(|point| point.swap(0, 1)));
            assert_agree(&program, "a quarter turn", &answer, &turned.answer(&device), |[x, y, z]| [-y, x, z]);
        }
        for scale in [0.25, 1024.0] {
            let scaled = Program {
                sets: program.sets.iter().map(|set| set.iter().map(|x| x * scale).collect()).collect(),
                sides: program.sides.iter().map(|side| side * scale).collect(),
                ..program.clone()
            };
            assert_agree(&program, "a larger or smaller box", &answer, &scaled.answer(&device), same);
        }
        let corner: Vec<f64> = (0..dim).map(|axis| [3.0, -17.0, 4096.0][axis]).collect();
        let moved = Program {
            sets: program
                .sets
                .iter()
                .map(|set| set.iter().enumerate().map(|(c, x)| x + corner[c % dim]).collect())
                .collect(),
            corner,
            ..program.clone()
        };
        // Coordinates keep all of their digits.
        assert_agree(&program, "a box elsewhere", &answer, &moved.answer(&device), same);
    }
}

#[test]
fn what_is_not_the_same_is_seen() {
    let device = cpu(1);
    let program = (0..).map(Program::random).find(|program| program.dim() > 1).unwrap();
    let answer = program.answer(&device);
    assert_eq!(differ(&program, &answer, &program.answer(&device), same), None);
    let mut other = program.clone();
    other.sets[0][0] = (other.sets[0][0] + 0.01).rem_euclid(other.sides[0]);
    assert!(differ(&program, &answer, &other.answer(&device), same).is_some(), "a point moved by a hundredth");
    let mut wrong = program.answer(&device);
    wrong.power.iter_mut().enumerate().for_each(|(k, p)| *p += if k == 5 { 1e-2 } else { 0.0 });
    assert!(differ(&program, &answer, &wrong, same).is_some(), "a mode off by a hundredth");
    assert!(differ(&program, &answer, &answer, |[x, y, z]| [y, x, z]).is_some(), "axes mistaken for each other");
}
