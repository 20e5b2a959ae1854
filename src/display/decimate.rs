//! Of many points that would be drawn into one column of pixels, those that look the same.

/// A curve with the first, the lowest, the highest and the last point of every column that has more than four, so that its
/// picture is the same and no larger than the frame.
pub fn thinned_line<P: Copy, C: PartialEq>(run: &[P], column: impl Fn(&P) -> C, height: impl Fn(&P) -> f64) -> Vec<P> {
    let mut kept = Vec::new();
    for part in run.chunk_by(|a, b| column(a) == column(b)) {
        let by_height = |a: &usize, b: &usize| height(&part[*a]).total_cmp(&height(&part[*b]));
        let all = 0..part.len();
        match (all.clone().min_by(by_height), all.clone().max_by(by_height)) {
            (Some(lowest), Some(highest)) if part.len() > 4 => {
                let mut four = [0, lowest, highest, part.len() - 1];
                four.sort_unstable();
                kept.extend(four.map(|k| part[k]));
            }
            _ => kept.extend_from_slice(part),
        }
    }
    kept
}

/// A band, (x, low, high), with two points for every column that has more than four, as wide as the widest there.
pub fn thinned_band<C: PartialEq>(run: &[[f64; 3]], column: impl Fn(f64) -> C) -> Vec<[f64; 3]> {
    let mut kept = Vec::new();
    for part in run.chunk_by(|a, b| column(a[0]) == column(b[0])) {
        match part {
            [first, _, _, _, .., last] => {
                let low = part.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
                let high = part.iter().map(|p| p[2]).fold(f64::NEG_INFINITY, f64::max);
                kept.extend([[first[0], low, high], [last[0], low, high]]);
            }
            few => kept.extend_from_slice(few),
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_what_can_be_seen() {
        let line: Vec<(f64, f64)> = (0..10_000).map(|k| (f64::from(k), f64::from(k * 7919 % 10_007))).collect();
        let at = |x: f64| (x / 100.0).floor();
        let column = |p: &(f64, f64)| at(p.0);
        let kept = thinned_line(&line, column, |p| p.1);
        assert!(kept.len() <= 400 && kept.is_sorted_by_key(|p| p.0) && kept.iter().all(|p| line.contains(p)));
        let band: Vec<[f64; 3]> = line.iter().map(|&(x, y)| [x, y - 1.0, y + 1.0]).collect();
        let kept_band = thinned_band(&band, at);
        for (k, part) in line.chunks(100).enumerate() {
            let of = |kept: &[(f64, f64)]| {
                let there: Vec<f64> = kept.iter().filter(|p| at(p.0) == k as f64).map(|p| p.1).collect();
                (there.iter().copied().fold(f64::INFINITY, f64::min), there.iter().copied().fold(0.0, f64::max))
            };
            let (lo, hi) = of(part);
            assert_eq!(of(&kept), (lo, hi), "column {k}");
            let two: Vec<_> = kept_band.iter().filter(|p| at(p[0]) == k as f64).collect();
            assert!(two.len() == 2 && two.iter().all(|p| (p[1], p[2]) == (lo - 1.0, hi + 1.0)), "column {k}");
        }
        // Few points stay as they are.
        assert_eq!(thinned_line(&line[..4], column, |p| p.1), line[..4]);
        assert_eq!(thinned_band(&band[..4], at), band[..4]);
    }
}
