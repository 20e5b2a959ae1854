//! What a person can ask for. Who draws only names it; `app` does it.

use pairwave::display::Panel;
use pairwave::request::Request;

use crate::engine::SetId;
use crate::files::Choice;
use crate::view::View;

/// What is to be done.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Action {
    /// What a key does too.
    Keyed(Keyed),
    /// One panel fills the window, or all are shown again.
    Maximize(Option<Panel>),
    /// Asks other things of a set.
    Ask(SetId, Box<Request>),
    /// Shows things otherwise.
    Look(Box<View>),
    /// Another pair of axes of sets in 3D.
    Plane(usize),
    /// Selects a set.
    Select(SetId),
    /// Draws a set, and so measures it, or does not.
    Show(SetId, bool),
    /// Draws the points of another realization of a set.
    Realization(SetId, u64),
    /// Leaves a set as it is, or goes on with it.
    Cancel(SetId, bool),
    /// Removes a set.
    Remove(SetId),
    /// Adds a set of a sampler.
    AddSampler(&'static str),
    /// Asks for files.
    Choose(Choice),
    /// Takes something of a panel away.
    Take(Panel, Take),
}

/// What keys do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keyed {
    /// Opens or closes the overlay.
    Help,
    /// Closes what is open.
    Leave,
    /// Stops measuring, or goes on.
    Pause,
    /// One panel fills the window, by the number of the key.
    Panel,
    /// All panels again.
    AllPanels,
    /// Plots and pictures show all they have.
    ResetZoom,
    /// Shows or hides the controls.
    Controls,
    /// The next theme.
    Theme,
    /// Twice the realizations.
    More,
    /// Half of them.
    Fewer,
    /// Other random numbers.
    Seed,
    /// A set more.
    Add,
    /// The selected set once more.
    Duplicate,
    /// One set fewer.
    Remove,
    /// Selects the one before.
    Previous,
    /// Selects the one after.
    Next,
    /// Writes the session.
    SaveSession,
    /// Reads one.
    OpenSession,
    /// The equivalent command to the clipboard.
    CopyCommand,
}

/// Something to take away.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Take {
    CopyPicture,
    Shown,
    /// As shown, with so many times the pixels.
    Enlarged(u32),
    /// As shown, in lines and texts.
    Figure,
    /// The figure of the report.
    Svg,
    Png,
    Csv,
    Npy,
    Command,
}
