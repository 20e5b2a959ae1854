//! The page of a survey: its sheet or figures, with their tables.

use std::collections::BTreeMap;
use std::path::PathBuf;

use super::{Survey, Views};
use crate::display::escape;
use crate::display::figure::Figure;
use crate::report::{Columns, Numbers, Page};
use crate::statistics::Table;

/// The page, from the first of the tables, which are the scalars, and the others.
pub(super) fn page(
    survey: &Survey,
    command: &str,
    tables: &[(&'static str, Table)],
    figures: &[(&'static str, Figure)],
    sheet: Option<&str>,
) -> Result<String, Box<dyn std::error::Error + Send + Sync>> {
    let seen = match survey.views {
        Views::Projections => "every pair of axes",
        Views::Prefixes(_) => "the first points of every realization",
    };
    let shape = survey.shape;
    let lead = format!("{seen}; n = {}, K = {}, {} axes", shape.mean_points, shape.realizations, survey.dim);
    let mut page = Page::new(&survey.subject, &lead);
    page.warnings(&survey.warnings);
    let read = |(name, table): &(&'static str, Table)| -> Result<_, Box<dyn std::error::Error + Send + Sync>> {
        Ok((*name, Columns::read(PathBuf::from(name), &table.csv()?)?))
    };
    let all: BTreeMap<&'static str, Columns> = tables.iter().map(read).collect::<Result<_, _>>()?;
    let numbers = |name: &'static str| all.get(name).map(|columns| Numbers { name, columns, page: None });
    page.section(match survey.views {
        Views::Projections => "Projections",
        Views::Prefixes(_) => "Prefixes",
    });
    if let Some(sheet) = sheet {
        let caption = "Points of every pair of axes, and their power spectra on the other side of the diagonal.";
        let tables: Vec<_> = tables.iter().filter_map(|(name, _)| numbers(name)).collect();
        page.picture("projections", [sheet, "", caption], &[], &tables)?;
    }
    for (name, figure) in figures {
        let table = figure.numbers.and_then(|found| numbers(found.table));
        page.drawn(name.trim_end_matches(".svg"), figure, table, &format!("{}.", escape(&figure.title)))?;
    }
    page.section("How it was computed");
    page.typed(command);
    page.rows("How it was computed", &[("Device".into(), escape(&survey.device))]);
    Ok(page.finish("The numbers behind the pictures are in the CSV files next to this page."))
}
