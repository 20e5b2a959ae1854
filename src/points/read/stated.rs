//! The box that a file states.

use crate::error::{Result, number};
use crate::points::{Boundary, Domain};

/// The box of a file along the axes that were taken, and along which of them it is periodic, where the file says so.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedBox {
    ranges: Vec<(f64, f64)>,
    periodic: Option<Vec<bool>>,
}

const AXES: [&str; 3] = ["x", "y", "z"];

/// Which axis a coordinate of this name is along: `x`, and as LAMMPS calls it, `xs`, `xu` and `xsu`.
pub(super) fn axis_of(name: &str) -> Option<usize> {
    let lower = name.to_ascii_lowercase();
    let axis = AXES.iter().position(|axis| lower.starts_with(axis))?;
    ["", "s", "u", "su"].contains(&&lower[1..]).then_some(axis)
}

impl StatedBox {
    /// The part of a box that coordinates of these names are in: none where one of them is along no axis of it.
    pub(super) fn along<'a>(
        names: impl Iterator<Item = &'a str>,
        ranges: [(f64, f64); 3],
        periodic: Option<[bool; 3]>,
    ) -> Option<Self> {
        let axes: Vec<usize> = names.map(axis_of).collect::<Option<_>>()?;
        Some(Self {
            ranges: axes.iter().map(|&a| ranges[a]).collect(),
            periodic: periodic.map(|periodic| axes.iter().map(|&a| periodic[a]).collect()),
        })
    }

    /// The domain that it is, where nothing else is said than what happens at its sides.
    ///
    /// # Errors
    /// Why it is none.
    pub(crate) fn domain(&self, boundary: Option<Boundary>) -> Result<Domain, String> {
        let shown = self.ranges.iter().map(|(a, b)| format!("[{}, {})", number(*a), number(*b)));
        let shown = shown.collect::<Vec<_>>().join(" x ");
        let boundary = match (boundary, self.periodic.as_deref()) {
            (Some(boundary), _) => boundary,
            (None, None) => {
                return Err(format!("its box {shown} may be periodic or not; `domain` torus or window says which"));
            }
            (None, Some(periodic)) if periodic.iter().all(|&p| p) => Boundary::Torus,
            (None, Some(periodic)) if !periodic.iter().any(|&p| p) => Boundary::Window,
            (None, Some(_)) => {
                return Err(format!(
                    "its box {shown} is periodic along some axes and not along others, and a domain is a torus or a window; \
                     `domain` window takes it for a window, `columns` takes the axes that are alike"
                ));
            }
        };
        let domain = match boundary {
            Boundary::Torus => Domain::torus_at(&self.ranges),
            Boundary::Window => Domain::window(&self.ranges),
        };
        domain.map_err(|e| format!("its box {shown} is no domain: {e}; `window` or `sides` sets one"))
    }
}
