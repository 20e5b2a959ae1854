//! The house: what the README says of it is so, and its floors stand on each other.

mod floors;
mod readme;
