//! What is under the pointer, for every panel to mark.

use glam::DVec2;
use pairwave::display::{Form, Panel};

use crate::engine::SetId;

/// A place in one of the panels, in units of the analysis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// A distance r.
    Distance(f64),
    /// A frequency |nu|.
    Frequency(f64),
    /// A wave vector nu, to the right and upward.
    Mode(DVec2),
    /// A lag, to the right and upward.
    Lag(DVec2),
    /// A point of the first realization of a set, by its index.
    Point(SetId, usize),
    /// A variance of an integrand, by its place in the list.
    Variance(usize, Form),
    /// A place along the axis of what a variance comes from, as drawn.
    Share(f64),
}

/// What the pointer is at.
#[derive(Debug, Default)]
pub(crate) struct Hover {
    now: Option<(Panel, Place)>,
    next: Option<(Panel, Place)>,
}

impl Hover {
    /// The place, in whichever panel.
    pub(crate) fn place(&self) -> Option<Place> {
        self.now.map(|(_, place)| place)
    }

    /// Whether the pointer is in this panel.
    pub(crate) fn is_in(&self, panel: Panel) -> bool {
        self.now.is_some_and(|(at, _)| at == panel)
    }

    /// A panel says where in it the pointer is.
    pub(crate) fn at(&mut self, panel: Panel, place: Place) {
        self.next = Some((panel, place));
    }

    /// Ends a frame. Whether panels must be drawn anew.
    pub(crate) fn end_frame(&mut self) -> bool {
        let next = self.next.take();
        let changed = next != self.now;
        self.now = next;
        changed
    }

    /// What to mark along the first axis of a panel of curves.
    pub(crate) fn along(&self, panel: Panel) -> Option<f64> {
        if panel == Panel::Pcf { self.distance() } else { self.frequency() }
    }

    /// The distance r to mark: of a bin or of a lag.
    pub(crate) fn distance(&self) -> Option<f64> {
        match self.place()? {
            Place::Distance(r) => Some(r),
            Place::Lag(lag) => Some(lag.length()),
            _ => None,
        }
    }

    /// The frequency |nu| to mark: of a ring or of a mode.
    pub(crate) fn frequency(&self) -> Option<f64> {
        match self.place()? {
            Place::Frequency(nu) => Some(nu),
            Place::Mode(nu) => Some(nu.length()),
            _ => None,
        }
    }
}
