//! Chains of masses from `../data/chains.csv`, and their responses by definition.

use std::f64::consts::TAU;

use fmm_frf::{Complex64, FrequencyResponse, MeasuredResponse, ResponseForm};
use fmm_record::uff::Freedom;

/// A chain and its modes by an independent program.
#[derive(Debug, Default)]
pub(crate) struct Chain {
    masses: Vec<f64>,
    damping: Vec<Vec<f64>>,
    stiffness: Vec<Vec<f64>>,
    pub(crate) modes: Vec<Truth>,
}

/// A mode of a chain.
#[derive(Debug)]
pub(crate) struct Truth {
    pub(crate) frequency: f64,
    pub(crate) ratio: f64,
    /// Of each mass for a force on the first (m/(N s)).
    pub(crate) residues: Vec<Complex64>,
}

/// The place of a mass, counted from 1.
pub(crate) fn place(mass: usize) -> Freedom {
    Freedom { node: i32::try_from(mass).unwrap(), direction: 1, ..Freedom::default() }
}

impl Chain {
    pub(crate) fn read(name: &str) -> Self {
        let mut chain = Self::default();
        for line in include_str!("../data/chains.csv").lines().filter(|line| !line.starts_with('#')).skip(1) {
            let mut cells = line.split(',');
            let (case, what) = (cells.next().unwrap(), cells.next().unwrap());
            if case != name {
                continue;
            }
            let numbers: Vec<f64> = cells.map(|cell| cell.parse().unwrap()).collect();
            match what {
                "m" => chain.masses = numbers,
                "c" => chain.damping.push(numbers),
                "k" => chain.stiffness.push(numbers),
                _ => chain.modes.push(Truth {
                    frequency: numbers[0],
                    ratio: numbers[1],
                    residues: numbers[2..].chunks(2).map(|pair| Complex64::new(pair[0], pair[1])).collect(),
                }),
            }
        }
        assert!(!chain.modes.is_empty(), "no chain {name}");
        chain
    }

    pub(crate) fn size(&self) -> usize {
        self.masses.len()
    }

    /// Column `force` of (K + sC + s²M)⁻¹.
    fn receptances(&self, s: Complex64, force: usize) -> Vec<Complex64> {
        let n = self.size();
        let mut rows: Vec<Vec<Complex64>> = (0..n)
            .map(|i| {
                let inertia = |j| if i == j { s * s * self.masses[i] } else { Complex64::ZERO };
                let entry = |j: usize| self.stiffness[i][j] + s * self.damping[i][j] + inertia(j);
                let right = if i == force { Complex64::ONE } else { Complex64::ZERO };
                (0..n).map(entry).chain([right]).collect()
            })
            .collect();
        for pivot in 0..n {
            let best = (pivot..n).max_by(|a, b| rows[*a][pivot].norm().total_cmp(&rows[*b][pivot].norm())).unwrap();
            rows.swap(pivot, best);
            let row = rows[pivot].clone();
            for other in (0..n).filter(|other| *other != pivot) {
                let factor = rows[other][pivot] / row[pivot];
                rows[other].iter_mut().zip(&row).for_each(|(to, from)| *to -= factor * from);
            }
        }
        (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
    }

    /// Responses of all masses to a force on one, at the lines, and the places of both.
    pub(crate) fn responses(&self, form: ResponseForm, lines: &[f64], force: usize) -> Vec<MeasuredResponse> {
        let columns: Vec<Vec<Complex64>> =
            lines.iter().map(|f| self.receptances(Complex64::new(0.0, TAU * f), force)).collect();
        let of = |mass: usize| {
            let values = lines
                .iter()
                .zip(&columns)
                .map(|(frequency, column)| ResponseForm::Receptance.convert(form, column[mass], *frequency).unwrap());
            let response = FrequencyResponse::new(form, lines.to_vec(), values.collect()).unwrap();
            MeasuredResponse::new(response).between(place(mass + 1), place(force + 1))
        };
        (0..self.size()).map(of).collect()
    }
}

/// Lines from `low` to `high` (Hz), so many of them.
pub(crate) fn lines(low: f64, high: f64, count: u32) -> Vec<f64> {
    (0..count).map(|i| low + (high - low) * f64::from(i) / f64::from(count - 1)).collect()
}
