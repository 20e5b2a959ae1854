//! The worker without a window: what it ends with, and that it can be interrupted at any time.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use crate::common::{by_command, request, written};
use pairwave::analysis::Analysis;
use pairwave::compute::Device;
use pairwave::control::Control;
use pairwave::convergence::{self, Subjects};
use pairwave::request::Request;
use pairwave_viewer::engine::{Climbed, SetId, Snapshot};
use pairwave_viewer::worker::Worker;

/// Longer than anything here takes: a wait that ends is a failure.
const NEVER: Duration = Duration::from_secs(300);

fn worker() -> (Worker, Receiver<()>) {
    let (tell, told) = channel();
    // Nobody listens any more once a test ends.
    let worker = Worker::new(move || _ = tell.send(())).unwrap();
    (worker, told)
}

/// Waits for what a set is at.
fn wait(worker: &Worker, told: &Receiver<()>, id: SetId, until: impl Fn(&Snapshot) -> bool) -> Arc<Snapshot> {
    loop {
        if let Some(latest) = worker.latest(id).filter(|s| until(s)) {
            return latest;
        }
        told.recv_timeout(NEVER).unwrap();
    }
}

/// The files of numbers among all.
fn numbers(files: BTreeMap<String, Vec<u8>>) -> BTreeMap<String, Vec<u8>> {
    files.into_iter().filter(|(name, _)| name.ends_with(".csv") || name.ends_with(".npy")).collect()
}

fn assert_equal(snapshot: &Snapshot, request: &Request) {
    let (found, expected) = (numbers(written(snapshot.analysis.as_ref().unwrap())), numbers(by_command(request)));
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    for (name, bytes) in &expected {
        assert!(found[name] == *bytes, "{name} differs");
    }
}

const STATS: &str = "--stats pcf,spectrum,pcf-vector --max-frequency 16 --lag-bins 16";

#[test]
fn it_ends_with_the_bytes_of_the_command() {
    let (worker, told) = worker();
    let requests = [
        request(&format!("--sampler jittered -n 144 -k 37 {STATS}")),
        request(&format!("--sampler thomas -n 100 -k 5 --seed 2 {STATS}")),
    ];
    for (id, request) in (1..).zip(&requests) {
        worker.set(id, request.clone());
    }
    for (id, request) in (1..).zip(&requests) {
        let end = wait(&worker, &told, id, |s| s.done);
        assert_equal(&end, request);
        assert!(end.error.is_none() && end.request == *request);
    }
}

#[test]
fn the_difference_of_another_request_is_seen() {
    let (worker, told) = worker();
    let (one, other) = (request("--sampler random -n 50 -k 3"), request("--sampler random -n 50 -k 3 --seed 2"));
    worker.set(1, one);
    let end = wait(&worker, &told, 1, |s| s.done);
    assert_ne!(numbers(written(end.analysis.as_ref().unwrap())), numbers(by_command(&other)));
}

#[test]
fn errors_shrink_while_realizations_come_in() {
    let (worker, told) = worker();
    worker.set(1, request("--sampler random -n 3000 -k 400 --stats pcf --bins 8"));
    let error = |s: &Snapshot| s.analysis.as_ref().unwrap().pair_correlation().unwrap().g_se[6];
    let early = wait(&worker, &told, 1, |s| s.analysis.is_some());
    let end = wait(&worker, &told, 1, |s| s.done);
    let status = |s: &Snapshot| s.status.as_ref().unwrap().tracks[0].done;
    assert!(status(&early) < status(&end), "{} was the first look", status(&early));
    assert!(error(&end) < error(&early));
}

/// What is drawn by the processor must not keep it from measuring: the first and the last result come at once, others when it is
/// time.
#[test]
fn results_come_no_more_often_than_they_can_be_drawn() {
    let (worker, told) = worker();
    worker.pace(NEVER);
    worker.set(1, request("--sampler random -n 1000 -k 400 --stats pcf"));
    wait(&worker, &told, 1, |s| s.done);
    assert!(worker.latest(1).unwrap().generation <= 2);
    // Other settings are seen at once.
    worker.set(1, request("--sampler random -n 1000 -k 100000000 --stats pcf"));
    wait(&worker, &told, 1, |s| !s.done && s.analysis.is_some());
}

/// Variances against n are those of the command, whether or not they were interrupted, and stay where only panels change.
#[test]
fn variances_against_the_number_of_points_are_those_of_the_command() {
    let (worker, told) = worker();
    let line = "--sampler jittered -n 144 -k 40 --stats radial --integrand disk --integrand gaussian";
    let asked = request(line);
    let climbed = |s: &Snapshot| s.climb.as_ref().is_some_and(Climbed::is_done);
    worker.set(1, asked.clone());
    let without = wait(&worker, &told, 1, |s| s.done);
    assert!(without.climb.is_none(), "not asked for");
    worker.climb(1, true);
    wait(&worker, &told, 1, |s| s.climb.as_ref().is_some_and(|climb| climb.progress.0 > 0));
    worker.climb(1, false);
    worker.set(2, request("--sampler random -n 50 -k 3"));
    wait(&worker, &told, 2, |s| s.done);
    worker.climb(1, true);
    let end = wait(&worker, &told, 1, climbed);
    let found = end.climb.as_ref().unwrap().found.clone().unwrap();

    let subjects = Subjects::Samplers(vec!["jittered".into()], "18,36,72,144".parse().unwrap());
    let device = pollster::block_on(Device::open(asked.device, asked.threads)).unwrap();
    let expected = convergence::run(&subjects, &asked.only(&[]), &device, &Control::default(), &mut |_| ()).unwrap();
    assert_eq!(found.text(), expected.text());
    let ladders = found.ladders(1);
    assert!(ladders.len() == 1 && ladders[0].spec.starts_with("gaussian"), "{ladders:?}");
    // Squares near the halves of 144.
    assert_eq!(ladders[0].points.iter().map(|at| at.n).collect::<Vec<_>>(), [16.0, 36.0, 64.0, 144.0]);

    worker.set(1, request(&line.replace("radial", "pcf")));
    let other = wait(&worker, &told, 1, |s| s.done && s.analysis.as_ref().is_some_and(|a| a.radial().is_none()));
    assert!(Arc::ptr_eq(&found, other.climb.as_ref().unwrap().found.as_ref().unwrap()));
    // Other realizations are others at every n.
    worker.set(1, request(&line.replace("40", "41")));
    let other = wait(&worker, &told, 1, |s| climbed(s) && s.request.input.realizations == Some(41));
    assert_ne!(other.climb.as_ref().unwrap().found.as_ref().unwrap().text(), found.text());
}

/// Files have no other numbers of points, and say so.
#[test]
fn files_have_no_variances_against_the_number_of_points() {
    let (worker, told) = worker();
    let file = tempfile::Builder::new().suffix(".csv").tempfile().unwrap();
    std::fs::write(file.path(), "x,y\n0.1,0.2\n0.6,0.7\n").unwrap();
    worker.climb(1, true);
    worker.set(1, request(&format!("{} --integrand disk", file.path().display())));
    let end = wait(&worker, &told, 1, |s| s.climb.is_some());
    let climb = end.climb.as_ref().unwrap();
    assert!(climb.is_done() && climb.found.is_none());
    assert_eq!(climb.error.as_deref(), Some("only samplers make points of other numbers"));
}

#[test]
fn a_set_is_given_up_in_the_middle() {
    let (worker, told) = worker();
    worker.set(1, request("--sampler random -n 20000 -k 100000 --stats pcf"));
    wait(&worker, &told, 1, |s| s.analysis.is_some());
    worker.remove(1);
    let other = request("--sampler random -n 50 -k 3");
    worker.set(2, other.clone());
    assert_equal(&wait(&worker, &told, 2, |s| s.done), &other);
    assert!(worker.latest(1).is_none());
}

#[test]
fn one_long_step_is_given_up_too() {
    // A single realization of this takes minutes.
    let (worker, told) = worker();
    worker.set(1, request("--sampler random -n 3000000 -k 1 --stats pcf --r-max 0.5"));
    let other = request("--sampler random -n 50 -k 3");
    std::thread::sleep(Duration::from_millis(1500));
    worker.set(1, other.clone());
    assert_equal(&wait(&worker, &told, 1, |s| s.done), &other);
    worker.set(1, request("--sampler random -n 3000000 -k 1 --stats pcf --r-max 0.5"));
    // Dropping the worker ends it as well.
}

#[test]
fn settings_changed_a_thousand_times_end_where_the_last_one_says() {
    let (worker, told) = worker();
    let asked = |i: usize| {
        // Settings of statistics that are not wanted would be refused.
        let stats = [
            "pcf,spectrum --bins 256 --max-frequency 8",
            "pcf --bins 128",
            "radial --max-frequency 8",
            "pcf-vector,spectrum --max-frequency 12 --lag-bins 8",
        ];
        request(&format!(
            "--sampler jittered -n {} -k {} --seed {} --stats {}",
            [64, 100][i / 100 % 2],
            1 + i * 7 % 50,
            1 + i / 250,
            stats[i / 3 % 4],
        ))
    };
    for i in 0..1000 {
        worker.set(1, asked(i));
        if i % 50 == 0 {
            wait(&worker, &told, 1, |s| s.analysis.is_some());
        }
    }
    let last = asked(999);
    assert_equal(&wait(&worker, &told, 1, |s| s.done && s.request == last), &last);
}

#[test]
fn dragged_settings_leave_nothing_behind() {
    let (worker, told) = worker();
    let mut seen = Vec::new();
    for n in 100..300 {
        let asked = request(&format!("--sampler random -n {n} -k 20 --stats pcf"));
        worker.set(1, asked.clone());
        let snapshot = wait(&worker, &told, 1, |s| s.request == asked && s.analysis.is_some());
        seen.push((Arc::downgrade(&snapshot), Arc::downgrade(snapshot.analysis.as_ref().unwrap())));
    }
    wait(&worker, &told, 1, |s| s.done);
    let kept = |(snapshot, analysis): &&(std::sync::Weak<Snapshot>, std::sync::Weak<Analysis>)| {
        snapshot.strong_count() + analysis.strong_count() > 0
    };
    assert!(seen.iter().filter(kept).count() <= 1);
}

#[test]
fn a_pause_stops_and_goes_on() {
    let (worker, told) = worker();
    let long = request("--sampler random -n 2000 -k 3000 --stats pcf");
    worker.set(1, long.clone());
    wait(&worker, &told, 1, |s| s.analysis.is_some());
    worker.pause(true);
    // The step under way when the pause came may still be shown, no other.
    std::thread::sleep(Duration::from_millis(500));
    let done = |s: &Snapshot| s.status.as_ref().unwrap().tracks[0].done;
    let before = worker.latest(1).unwrap();
    assert!(!before.done && done(&before) < 3000, "nothing is left that a pause could stop");
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(done(&worker.latest(1).unwrap()), done(&before));
    worker.pause(false);
    assert_equal(&wait(&worker, &told, 1, |s| s.done), &long);
}

#[test]
fn a_set_is_held_while_another_goes_on() {
    let (worker, told) = worker();
    let (long, short) =
        (request("--sampler random -n 500 -k 3000 --stats pcf"), request("--sampler random -n 50 -k 3"));
    worker.set(1, long.clone());
    wait(&worker, &told, 1, |s| s.analysis.is_some());
    worker.hold(1, true);
    worker.set(2, short.clone());
    assert_equal(&wait(&worker, &told, 2, |s| s.done), &short);
    assert!(!worker.latest(1).unwrap().done);
    worker.hold(1, false);
    assert_equal(&wait(&worker, &told, 1, |s| s.done), &long);
}

#[test]
fn errors_are_shown_and_left_behind() {
    let (worker, told) = worker();
    for (line, says) in [
        ("/nowhere/points.csv", "/nowhere/points.csv"),
        ("--sampler nothing -n 10", "nothing"),
        ("--sampler random -n 1 --stats pcf", "point"),
    ] {
        worker.set(1, request(line));
        let failed = wait(&worker, &told, 1, |s| s.error.as_ref().is_some_and(|e| e.contains(says)));
        assert!(!failed.done && failed.analysis.is_none(), "{line}");
    }
    let good = request("--sampler random -n 50 -k 3");
    worker.set(1, good.clone());
    assert_equal(&wait(&worker, &told, 1, |s| s.done), &good);
}
