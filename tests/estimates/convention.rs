//! The conventions of other programs, against rings small enough to be counted by hand.

use crate::common::{Rng, ensemble, lattice, raw, wait, wave_plan};
use pairwave::compute::Compute;
use pairwave::compute::reference::Reference;
use pairwave::control::Control;
use pairwave::estimate::{PowerSpectrum, PsaStatistics, RadialSpectrum};
use pairwave::plan::{Accuracy, Convention, WavePlan};
use pairwave::points::{Ensemble, RawPoints};

/// PSA's statistics of 144 jittered points, against the same formulas evaluated in Python (NumPy's sums, SciPy's Bessel function),
/// in which a window of 0.42 for 0.43 makes them 0 and 0.437, one of 0.081 for 0.08 0.365 and 0.4461, a rise at 0.97 an oscillation of
/// 0.4467, and a threshold of 0.2 for 0.1 an effective Nyquist frequency of 0.69.
#[test]
fn psa_statistics_of_few_points() {
    let (side, n) = (12, 144);
    let mut rng = Rng(3);
    let points: Vec<[f64; 2]> =
        (0..n).map(|i| [i % side, i / side].map(|c| (c as f64 + 0.5 * rng.unit()) / side as f64)).collect();
    let bins = PsaStatistics::bins(n as u64);
    let mut counts = vec![0; bins];
    for (j, a) in points.iter().enumerate() {
        for b in &points[..j] {
            let [dx, dy] = [a[0] - b[0], a[1] - b[1]].map(|d| d - d.round());
            if let Some(count) = counts.get_mut((dx.hypot(dy) * 2.0 * bins as f64) as usize) {
                *count += 1;
            }
        }
    }
    assert_eq!((bins, counts.iter().sum::<u64>()), (1200, 8039));
    let found = PsaStatistics::new(n as u64, &[counts]).unwrap();
    assert!((found.effective_nyquist - 0.355).abs() < 1e-12, "{found:?}");
    assert!((found.oscillation - 0.446_452_916_886_463).abs() < 1e-10, "{found:?}");
}

fn radial(sets: &[RawPoints], f: u32, convention: Convention, bugs: bool) -> (WavePlan, PowerSpectrum, RadialSpectrum) {
    let points: Ensemble = ensemble(sets);
    let dim = sets[0].dim;
    let plan = wave_plan(&points, &vec![f; dim], Accuracy::High).with_conventions(convention.resolve(bugs)).unwrap();
    let power = wait(Reference.wave_power(&plan, &points, &Control::default())).unwrap();
    let spectrum = PowerSpectrum::new(&plan, &power);
    let radial = RadialSpectrum::new(&plan, &power, &spectrum);
    (plan, spectrum, radial)
}

/// Two points half a side apart: P is 2 where m_x is even and 0 where it is odd.
fn pair() -> RawPoints {
    raw(2, vec![0.0, 0.0, 0.5, 0.0])
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-12
}

#[test]
fn rings_are_those_counted_by_hand() {
    let members = |c, f| radial(&[pair()], f, c, false).2.rings.iter().map(|r| r.modes).collect::<Vec<_>>();
    // |m|^2 < 4; < 16.
    assert_eq!(members(Convention::Psa, 4), [9, 36]);
    // Five along each axis: |m|^2 < 4, and the corners too.
    assert_eq!(members(Convention::Utk, 2), [9, 16]);
    // 1 <= |m|^2 < 4; 4 <= |m|^2 < 9.
    assert_eq!(members(Convention::Pspec, 3), [8, 16]);

    let (_, _, psa) = radial(&[pair()], 4, Convention::Psa, false);
    let first = &psa.rings[0];
    // DC, (0, 1) and (0, -1) have P = 2, the six with m_x = +-1 have 0.
    assert!(close(first.p, 6.0 / 9.0), "{}", first.p);
    let variance = (3.0 * (2.0 - 2.0 / 3.0f64).powi(2) + 6.0 * (2.0 / 3.0f64).powi(2)) / 8.0;
    assert!(close(first.anisotropy_db.unwrap(), 10.0 * (variance / (4.0 / 9.0)).log10()));
    assert_eq!([first.nu_lo, first.nu, first.nu_hi, psa.rings[1].nu], [0.0, 0.0, 2.0, 2.0]);
    // DC does not scatter: the others sum to 4 of the 9, four pairs of mirror images.
    assert!(close(first.p_se, 4.0 / 9.0 / 2.0), "{}", first.p_se);
    assert_eq!(first.independent_modes, 4);

    let (_, spectrum, utk) = radial(&[pair()], 2, Convention::Utk, false);
    assert!(close(utk.rings[0].p, 6.0 / 9.0));
    assert!(close(utk.rings[1].nu, 2.0 / 2f64.sqrt()), "labels in units of sqrt(n)");
    assert_eq!(utk.rings[0].anisotropy_db, None);
    assert_eq!(spectrum.dc(), Some((2.0, 0.0)), "P(0) does not scatter");

    let (_, _, pspec) = radial(&[pair()], 3, Convention::Pspec, false);
    assert!(close(pspec.rings[0].p, 0.5));
    assert_eq!([pspec.rings[0].nu_lo, pspec.rings[0].nu, pspec.rings[0].nu_hi], [1.0, 1.0, 2.0]);

    // In 3D UTK's first ring holds the 27 modes with |m|^2 <= 3.
    let (_, _, cube) = radial(&[lattice(3, 2)], 2, Convention::Utk, false);
    assert_eq!(cube.rings[0].modes, 27);
}

#[test]
fn grids_are_as_wide_as_theirs() {
    let widths = |c: Convention, n: [u64; 3]| n.map(|n| c.resolve(false).max_frequency(n));
    assert_eq!(widths(Convention::Psa, [1024, 576, 16]), [Some(160), Some(120), Some(20)]);
    // 320, 100 and 17 frequencies per axis, made odd downwards where they are even.
    assert_eq!(widths(Convention::Utk, [1024, 100, 3]), [Some(159), Some(49), Some(8)]);
    assert_eq!(widths(Convention::Pspec, [1, 1024, 1 << 20]), [Some(750); 3]);
    assert_eq!(widths(Convention::Ours, [1, 2, 3]), [None; 3]);
}

#[test]
fn defects_come_only_when_asked_for() {
    // UTK: P(0) is set to 0 but still counted.
    let (_, spectrum, utk) = radial(&[pair()], 2, Convention::Utk, true);
    assert!(close(utk.rings[0].p, 4.0 / 9.0), "{}", utk.rings[0].p);
    assert_eq!(utk.rings[0].modes, 9);
    assert_eq!(spectrum.dc(), Some((0.0, 0.0)));
    // PSA: P = 0 becomes 0 dB, and the reference line -K dB.
    for (bugs, anisotropy, reference) in [(false, None, -10.0 * 2f64.log10()), (true, Some(0.0), -2.0)] {
        let (_, _, psa) = radial(&[lattice(2, 8), lattice(2, 8)], 6, Convention::Psa, bugs);
        assert_eq!(psa.rings[1].anisotropy_db, anisotropy);
        assert!(close(psa.anisotropy_reference_db, reference));
    }
    let (_, _, one) = radial(&[lattice(2, 8)], 6, Convention::Psa, true);
    assert_eq!(one.anisotropy_reference_db, 0.0);
}
