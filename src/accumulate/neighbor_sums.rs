//! Raw sums of nearest-neighbour statistics: integers, and a few numbers per realization, kept in the order of its index.
//! A merge of parts equals the whole, bit for bit, however the batch was cut.

use super::{ComputedBy, Decoder, Encoder, Sums};
use crate::error::{Error, Result};

/// Steps per unit of `DistributionSums::counts`.
pub const COUNT_STEPS: f64 = 4_294_967_296.0;

/// Nearest-neighbour statistics of a batch.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct NeighborSums {
    /// Per realization, ordered by index.
    pub realizations: Vec<RealizationNeighbors>,
    /// Distances from each point to the nearest other point, behind G.
    pub nearest: DistributionSums,
    /// Distances from each test point to the nearest point, behind F.
    pub empty: DistributionSums,
}

/// What is kept of one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RealizationNeighbors {
    /// Index in the whole batch.
    pub index: u64,
    /// Number of points.
    pub n: u64,
    /// The distances; `None` with fewer than two points, where there is no neighbour.
    pub distances: Option<Distances>,
    /// Bonds between neighbours in the plane, or why there are none.
    pub bonds: Result<Bonds, NoBonds>,
}

/// Nearest-neighbour distances within one realization, in the domain's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distances {
    /// Distance of the closest pair.
    pub minimum: f64,
    /// Mean over points of the distance to the nearest other point.
    pub mean: f64,
    /// Distance of neighbours in the closest packing of n points, `d_hex`.
    pub closest_packing: f64,
}

/// Bond-orientational order of one realization.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonds {
    /// Number of points that count.
    pub points: u64,
    /// How many of them have 5, 6 and 7 neighbours.
    pub with_neighbors: [u64; 3],
    /// Mean over points of `|psi_6|`.
    pub local: f64,
    /// Modulus of the mean over points of `psi_6`.
    pub global: f64,
}

/// Why a realization has no bonds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NoBonds {
    /// Defined in two dimensions only.
    NotPlanar,
    /// Fewer than 3 points.
    FewPoints,
    /// The points lie on one line.
    OneLine,
    /// A quarter of the points or more lie on one line.
    ManyOnOneLine,
    /// The points leave too much of the box empty, or it is too thin.
    EmptyOrThin,
    /// The points leave too much of the box empty.
    Empty,
    /// No point is surrounded by others.
    AllOutside,
    /// Not asked for.
    NotAskedFor,
    /// Neighbours across a notch or a hole of a polygon are none.
    InPolygon,
}

impl NoBonds {
    const ALL: [Self; 9] = [
        Self::NotPlanar,
        Self::FewPoints,
        Self::OneLine,
        Self::ManyOnOneLine,
        Self::EmptyOrThin,
        Self::Empty,
        Self::AllOutside,
        Self::NotAskedFor,
        Self::InPolygon,
    ];

    /// In words.
    pub fn why(self) -> &'static str {
        match self {
            Self::NotPlanar => "defined in two dimensions only",
            Self::FewPoints => "fewer than 3 points",
            Self::OneLine => "the points lie on one line",
            Self::ManyOnOneLine => "a quarter of the points or more lie on one line",
            Self::EmptyOrThin => "the points leave too much of the box empty, or it is too thin",
            Self::Empty => "the points leave too much of the box empty",
            Self::AllOutside => "no point is surrounded by others",
            Self::NotAskedFor => "not asked for",
            Self::InPolygon => "not computed in a polygon, across whose notches and holes points are no neighbours",
        }
    }
}

/// Of one realization: a distribution function of distances, times the number of distances.
#[derive(Debug, Clone, PartialEq)]
pub struct DistributionCounts {
    /// Number of distances N.
    pub points: u64,
    /// N times the estimate, at each r, in steps of 2^-32. Without censoring a number of distances below r.
    pub counts: Vec<u128>,
    /// Distances known to be at least r.
    pub at_risk: Vec<u64>,
}

/// Sums over realizations of what the ratio `sum c / sum N` and its error need; c and N as in `DistributionCounts`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DistributionSums {
    /// Number of realizations.
    pub realizations: u64,
    /// `sum N`.
    pub points: u128,
    /// `sum N^2`.
    pub squared_points: u128,
    /// Per r, `sum c`.
    pub counts: Vec<u128>,
    /// Per r, `sum c^2`.
    pub squares: Vec<u128>,
    /// Per r, `sum c N`.
    pub products: Vec<u128>,
    /// Per r, distances known to be at least r.
    pub at_risk: Vec<u128>,
}

impl DistributionSums {
    fn add(&mut self, one: &DistributionCounts) {
        let points = u128::from(one.points);
        self.merge(&Self {
            realizations: 1,
            points,
            squared_points: points * points,
            squares: one.counts.iter().map(|c| c.saturating_mul(*c)).collect(),
            products: one.counts.iter().map(|c| c.saturating_mul(points)).collect(),
            at_risk: one.at_risk.iter().map(|&n| u128::from(n)).collect(),
            counts: one.counts.clone(),
        });
    }

    fn merge(&mut self, other: &Self) {
        self.realizations += other.realizations;
        self.points += other.points;
        self.squared_points += other.squared_points;
        for (sums, more) in [
            (&mut self.counts, &other.counts),
            (&mut self.squares, &other.squares),
            (&mut self.products, &other.products),
            (&mut self.at_risk, &other.at_risk),
        ] {
            sums.resize(sums.len().max(more.len()), 0);
            // Saturated squares spoil an error bar, never a mean, and in any order alike.
            sums.iter_mut().zip(more).for_each(|(a, b)| *a = a.saturating_add(*b));
        }
    }
}

impl NeighborSums {
    /// No realizations yet, at so many distances.
    pub(crate) fn at(distances: usize) -> Self {
        let none = || DistributionSums {
            counts: vec![0; distances],
            squares: vec![0; distances],
            products: vec![0; distances],
            at_risk: vec![0; distances],
            ..DistributionSums::default()
        };
        Self { realizations: Vec::new(), nearest: none(), empty: none() }
    }

    /// Adds the realization that follows.
    pub(crate) fn add(&mut self, one: RealizationNeighbors, nearest: &DistributionCounts, empty: &DistributionCounts) {
        self.realizations.push(one);
        self.nearest.add(nearest);
        self.empty.add(empty);
    }

    /// Adds other realizations of the same process, measured by the same plan.
    ///
    /// # Errors
    /// Realizations that both hold.
    pub fn merge(&mut self, other: &Self) -> Result<()> {
        let lengths = |sums: &Self| [&sums.nearest, &sums.empty].map(|sums| sums.counts.len());
        let both = lengths(self).into_iter().zip(lengths(other));
        if let Some((a, b)) = both.into_iter().find(|(a, b)| a != b && *a > 0 && *b > 0) {
            return Err(Error::input("neighbor statistics", format!("{a} distances cannot be merged with {b}")));
        }
        // Batches mostly come in order, one after the other.
        let follows = self.realizations.last().map(|r| r.index) < other.realizations.first().map(|r| r.index);
        if follows {
            self.realizations.extend_from_slice(&other.realizations);
        } else {
            let mut merged = [self.realizations.as_slice(), &other.realizations].concat();
            merged.sort_by_key(|r| r.index);
            if let Some(twice) = merged.windows(2).find(|w| w[0].index == w[1].index) {
                let reason = format!("both parts hold realization {}", twice[0].index);
                return Err(Error::input("neighbor statistics", reason));
            }
            self.realizations = merged;
        }
        self.nearest.merge(&other.nearest);
        self.empty.merge(&other.empty);
        Ok(())
    }
}

/// Nearest-neighbour statistics of two classes A and B: within A, within B, from A to B, and from B to A.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CrossNeighborSums(pub [NeighborSums; 4]);

/// Names of its parts.
const PARTS: [&str; 4] = ["a", "b", "from_a", "from_b"];

impl Sums for CrossNeighborSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        self.0.iter_mut().zip(&other.0).try_for_each(|(a, b)| a.merge(b))
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        for (name, part) in PARTS.into_iter().zip(&self.0) {
            out.within(name, |out| part.encode(out));
        }
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let mut parts = Self::default();
        for (name, part) in PARTS.into_iter().zip(&mut parts.0) {
            *part = from.within(name, NeighborSums::decode)?;
        }
        Ok(parts)
    }
}

impl DistributionSums {
    fn encode(&self, name: &str, out: &mut Encoder) {
        out.within(name, |out| {
            out.value("realizations", self.realizations);
            out.u128s("points", [self.points, self.squared_points]);
            for (name, sums) in self.sums() {
                out.u128s(name, sums.iter().copied());
            }
        });
    }

    fn sums(&self) -> [(&'static str, &Vec<u128>); 4] {
        [("counts", &self.counts), ("squares", &self.squares), ("products", &self.products), ("at_risk", &self.at_risk)]
    }

    fn decode(name: &str, from: &mut Decoder<'_>) -> Result<Self> {
        from.within(name, |from| {
            let points = from.u128s("points")?;
            let &[points, squared_points] = points.as_slice() else { return Err(from.error("points are not two")) };
            let read = Self {
                realizations: from.count("realizations")?,
                points,
                squared_points,
                counts: from.u128s("counts")?,
                squares: from.u128s("squares")?,
                products: from.u128s("products")?,
                at_risk: from.u128s("at_risk")?,
            };
            for (name, sums) in read.sums() {
                from.check_len(name, sums.len(), read.counts.len())?;
            }
            Ok(read)
        })
    }
}

impl RealizationNeighbors {
    /// Index, n, whether there are distances, 0 or why there are no bonds, points with bonds, with 5, 6 and 7 neighbours.
    fn integers(&self) -> [u64; 8] {
        let of = |why: NoBonds| NoBonds::ALL.iter().position(|&w| w == why).map_or(0, |k| k as u64 + 1);
        let ([a, b, c], points) = self.bonds.map_or(([0; 3], 0), |bonds| (bonds.with_neighbors, bonds.points));
        [self.index, self.n, u64::from(self.distances.is_some()), self.bonds.err().map_or(0, of), points, a, b, c]
    }

    /// Minimum, mean, closest packing, local and global order.
    fn numbers(&self) -> [f64; 5] {
        let [minimum, mean, closest] = self.distances.map_or([0.0; 3], |d| [d.minimum, d.mean, d.closest_packing]);
        let [local, global] = self.bonds.map_or([0.0; 2], |b| [b.local, b.global]);
        [minimum, mean, closest, local, global]
    }

    fn of(integers: &[u64; 8], numbers: &[f64; 5]) -> Option<Self> {
        let [index, n, some, why, points, a, b, c] = *integers;
        let [minimum, mean, closest_packing, local, global] = *numbers;
        let bonds = match why {
            0 => Ok(Bonds { points, with_neighbors: [a, b, c], local, global }),
            why => Err(*NoBonds::ALL.get(usize::try_from(why).ok()? - 1)?),
        };
        let distances = (some == 1).then_some(Distances { minimum, mean, closest_packing });
        Some(Self { index, n, distances, bonds })
    }
}

impl Sums for NeighborSums {
    fn merge(&mut self, other: Self) -> Result<()> {
        Self::merge(self, &other)
    }

    fn computed_by(&self) -> Option<&ComputedBy> {
        None
    }

    fn encode(&self, out: &mut Encoder) {
        out.u64s("integers", self.realizations.iter().flat_map(RealizationNeighbors::integers));
        out.f64s("numbers", self.realizations.iter().flat_map(RealizationNeighbors::numbers));
        self.nearest.encode("nearest", out);
        self.empty.encode("empty", out);
    }

    fn decode(from: &mut Decoder<'_>) -> Result<Self> {
        let (integers, numbers) = (from.u64s("integers")?, from.f64s("numbers")?);
        let (integers, _) = integers.as_chunks::<8>();
        from.check_len("numbers", numbers.len(), 5 * integers.len())?;
        let rows = integers.iter().zip(numbers.as_chunks::<5>().0);
        let realizations: Option<Vec<_>> = rows.map(|(i, x)| RealizationNeighbors::of(i, x)).collect();
        Ok(Self {
            realizations: realizations.ok_or_else(|| from.error("holds a realization that cannot be"))?,
            nearest: DistributionSums::decode("nearest", from)?,
            empty: DistributionSums::decode("empty", from)?,
        })
    }
}
