//! Responses as a table of places by places.

use fmm_record::uff::Freedom;

use super::measured::MeasuredResponse;

/// Positions of the responses in a table of outputs (rows) by references (columns).
pub(super) type Table = Vec<Vec<usize>>;

/// Responses of a shape: their positions and the places that they stand for.
pub(super) type Column<'a> = (Vec<usize>, Vec<&'a Freedom>);

/// Responses as a table of outputs by references, and true if its rows are the places of responses.
///
/// The side with fewer places has the references, as reciprocity allows; without a full table all are rows.
pub(super) fn table(responses: &[MeasuredResponse]) -> (Table, bool) {
    let different = |of: fn(&MeasuredResponse) -> &Freedom| {
        let mut places: Vec<&Freedom> = Vec::new();
        for response in responses {
            if !places.contains(&of(response)) {
                places.push(of(response));
            }
        }
        places
    };
    let (rows, columns) = (different(MeasuredResponse::response), different(MeasuredResponse::reference));
    let at = |row: &Freedom, column: &Freedom| {
        let mut found = responses
            .iter()
            .enumerate()
            .filter(|(_, measured)| measured.response() == row && measured.reference() == column);
        let (index, _) = found.next()?;
        found.next().is_none().then_some(index)
    };
    let full: Option<Table> = rows.iter().map(|row| columns.iter().map(|column| at(row, column)).collect()).collect();
    match full {
        Some(table) if rows.len() >= columns.len() => (table, true),
        Some(table) => {
            ((0..columns.len()).map(|column| table.iter().map(|row| row[column]).collect()).collect(), false)
        }
        None => ((0..responses.len()).map(|index| vec![index]).collect(), true),
    }
}

/// The columns of a table with the places of their rows.
pub(super) fn places<'a>(responses: &'a [MeasuredResponse], table: &Table, along_responses: bool) -> Vec<Column<'a>> {
    let column = |reference: usize| {
        let positions: Vec<usize> = table.iter().map(|row| row[reference]).collect();
        let place = |at: &usize| if along_responses { responses[*at].response() } else { responses[*at].reference() };
        let places = positions.iter().map(place).collect();
        (positions, places)
    };
    (0..table[0].len()).map(column).collect()
}
