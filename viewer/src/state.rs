//! What the window is about: sets, which of them is selected, how they are shown, and what is said of it. Plain data: who draws
//! borrows it, and `app` alone changes it.

use std::path::PathBuf;

use pairwave::display::Panel;
use pairwave::request::{PointsRequest, Request, Statistic};

use crate::engine::{Climbed, SetId, Snapshot};
use crate::messages::Messages;
use crate::set::{MOST_SETS, Set, Wanted, of_sampler, with_integrands};
use crate::view::{Integrals, View};

/// Realizations are not doubled beyond this.
const MOST_REALIZATIONS: u64 = 1 << 30;

/// All that is shown but what the pointer and the keyboard are at.
#[derive(Default)]
pub(crate) struct State {
    /// One to `MOST_SETS` of them, once the first is added.
    pub(crate) sets: Vec<Set>,
    /// The index of one of them.
    pub(crate) selected: usize,
    pub(crate) view: View,
    /// Whether measuring is stopped.
    pub(crate) paused: bool,
    /// Whether the help is open.
    pub(crate) help: bool,
    /// What came of files, sessions and exports.
    pub(crate) messages: Messages,
    /// How many sets there ever were: no number is given twice.
    ever: SetId,
}

impl State {
    /// The set that controls and pictures are of.
    pub(crate) fn selected_set(&self) -> Option<&Set> {
        self.sets.get(self.selected)
    }

    /// Changes a set.
    pub(crate) fn change(&mut self, id: SetId, change: impl FnOnce(&mut Set)) {
        if let Some(set) = self.sets.iter_mut().find(|set| set.id == id) {
            change(set);
        }
    }

    /// Selects a set.
    pub(crate) fn select(&mut self, id: SetId) {
        self.selected = self.index(id).unwrap_or(self.selected);
    }

    fn index(&self, id: SetId) -> Option<usize> {
        self.sets.iter().position(|set| set.id == id)
    }

    /// Adds a set and selects it; says so if there is no room.
    pub(crate) fn add(&mut self, request: Request) {
        if self.sets.len() >= MOST_SETS {
            self.messages.fail(format!("There is room for {MOST_SETS} sets: remove one first"));
            return;
        }
        let free = (0..MOST_SETS).find(|c| self.sets.iter().all(|s| s.color != *c));
        self.push((request, free.unwrap_or(0), true));
        self.selected = self.sets.len() - 1;
    }

    fn push(&mut self, (request, color, visible): Wanted) {
        self.ever += 1;
        self.sets.push(Set {
            id: self.ever,
            color,
            visible,
            cancelled: false,
            request,
            snapshot: None,
            realization: 0,
        });
    }

    /// Adds a set of a sampler, measured like the one that is selected.
    pub(crate) fn add_sampler(&mut self, name: &str) {
        let like = self.selected_set().map(|set| set.request.clone()).unwrap_or_default();
        self.add(of_sampler(&like, name));
    }

    /// Adds a set of a sampler that no other set is of.
    pub(crate) fn add_other(&mut self) {
        let names = || pairwave::samplers::registry().iter().map(|sampler| sampler.name);
        let other = |name: &&str| self.sets.iter().all(|set| set.request.input.sampler.as_deref() != Some(*name));
        if let Some(name) = names().find(other).or_else(|| names().next()) {
            self.add_sampler(name);
        }
    }

    /// Adds a set of files, one batch, measured like the set that is selected.
    pub(crate) fn add_files(&mut self, files: Vec<PathBuf>) {
        let mut request = self.selected_set().map(|set| set.request.clone()).unwrap_or_default();
        request.input = PointsRequest { files, ..PointsRequest::default() };
        self.add(request);
    }

    /// Has another function integrated over the points of the selected set.
    pub(crate) fn add_integrand(&mut self, spec: String) {
        let Some(set) = self.sets.get_mut(self.selected) else { return };
        self.messages.note(format!("Integrates {spec} over {}", set.name()));
        let specs = set.request.integrand.iter().cloned().chain([spec]).collect();
        set.request = with_integrands(&set.request, specs);
        self.view.show(Panel::Integration);
    }

    /// Adds the selected set once more.
    pub(crate) fn duplicate(&mut self) {
        if let Some(set) = self.selected_set() {
            self.add(set.request.clone());
        }
    }

    /// Shows these sets and no others; there must be at least one, and room for all.
    pub(crate) fn replace(&mut self, sets: Vec<Wanted>, selected: usize) {
        self.sets.clear();
        sets.into_iter().for_each(|set| self.push(set));
        self.selected = selected;
    }

    /// Removes a set; the last one stays.
    pub(crate) fn remove(&mut self, id: SetId) {
        if let Some(index) = self.index(id).filter(|_| self.sets.len() > 1) {
            self.sets.remove(index);
            self.selected = self.selected.min(self.sets.len() - 1);
        }
    }

    /// Removes the selected set; says so if it is the last.
    pub(crate) fn remove_selected(&mut self) {
        match self.selected_set().map(|set| set.id) {
            Some(id) if self.sets.len() > 1 => self.remove(id),
            _ => self.messages.note("The last set stays"),
        }
    }

    /// Twice the realizations of the selected set.
    pub(crate) fn double(&mut self) {
        self.draw_otherwise(|k, _| *k = k.saturating_mul(2).min(MOST_REALIZATIONS.max(*k)));
    }

    /// Half of them.
    pub(crate) fn halve(&mut self) {
        self.draw_otherwise(|k, _| *k = (*k / 2).max(1));
    }

    /// Other random numbers for the selected set.
    pub(crate) fn reseed(&mut self) {
        self.draw_otherwise(|_, seed| *seed = seed.wrapping_add(1));
    }

    /// Changes the number of realizations or the seed of the selected set; files have what they have.
    fn draw_otherwise(&mut self, change: impl FnOnce(&mut u64, &mut u64)) {
        let Some(set) = self.sets.get_mut(self.selected) else { return };
        let input = &mut set.request.input;
        if input.sampler.is_none() {
            self.messages.note("The realizations of a file are those in it: only samplers make others");
            return;
        }
        // Those that the command line takes where none are given.
        let before = (input.realizations.unwrap_or(1), input.seed.unwrap_or(1));
        let (mut realizations, mut seed) = before;
        change(&mut realizations, &mut seed);
        if realizations != before.0 {
            input.realizations = Some(realizations);
        }
        if seed != before.1 {
            input.seed = Some(seed);
        }
    }

    /// What is asked of the worker for a set: what its request says, of the statistics that the panels show.
    pub(crate) fn wanted(&self, set: &Set) -> Request {
        let mut stats = Vec::new();
        for statistic in Panel::ALL.iter().filter(|p| self.view.is_shown(**p)).flat_map(|p| p.statistics()) {
            if !stats.contains(statistic) {
                stats.push(*statistic);
            }
        }
        // Distances of neighbours are in no panel, and among the numbers.
        if self.view.numbers {
            stats.push(Statistic::Neighbors);
        }
        // Integrals are in one panel, below the points and over P.
        if self.view.is_shown(Panel::Integration) || self.view.integrand_below || self.view.attribution {
            set.request.only(&stats)
        } else {
            set.request.without_integrals().only(&stats)
        }
    }

    /// Whether variances of integrals at fewer points of a set are wanted.
    pub(crate) fn climbs(&self, set: &Set) -> bool {
        let seen = self.view.is_shown(Panel::Integration) && self.view.integrals == Integrals::Numbers;
        seen && set.visible && !set.request.integrand.is_empty()
    }

    /// Whether everything asked for is there.
    pub(crate) fn is_settled(&self) -> bool {
        let climbed = |set, s: &Snapshot| !self.climbs(set) || s.climb.as_ref().is_some_and(Climbed::is_done);
        let settled = |set, s: &Snapshot| s.done && climbed(set, s) || s.error.is_some();
        self.sets
            .iter()
            .filter(|s| s.visible && !s.cancelled)
            .all(|set| set.snapshot.as_deref().is_some_and(|s| settled(set, s) && s.request == self.wanted(set)))
    }
}
