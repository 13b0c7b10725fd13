//! The tables of the thesis as printed.

/// Mass (kg), stiffness (N/m) and viscous damping (N s/m): means of Table 2.
pub const MACHINE: [f64; 3] = [10.391, 1982.0, 0.275];
/// Their standard deviations by Table 2.
pub const MACHINE_DEVIATIONS: [f64; 3] = [0.0049, 1.3, 0.0341];

/// Table 1: free vibrations without contact. The announced row of 12 mm is missing (E6).
#[derive(Debug, Clone, Copy)]
pub struct FreeVibration {
    /// Initial displacement (mm).
    pub displacement: f64,
    /// Velocity (mm/s).
    pub velocity: f64,
    /// Mass (kg).
    pub mass: f64,
    /// Stiffness (N/m).
    pub stiffness: f64,
    /// Viscous damping (N s/m).
    pub damping: f64,
}

/// Table 1.
pub const TABLE_1: [FreeVibration; 9] = [
    free(4.0, 50.0, 10.394, 1981.0, 0.222),
    free(6.0, 76.0, 10.395, 1981.0, 0.235),
    free(8.0, 103.0, 10.393, 1981.0, 0.245),
    free(10.0, 129.0, 10.397, 1982.0, 0.256),
    free(14.0, 181.0, 10.392, 1982.0, 0.278),
    free(16.0, 207.0, 10.389, 1983.0, 0.288),
    free(18.0, 233.0, 10.389, 1984.0, 0.299),
    free(20.0, 258.0, 10.385, 1984.0, 0.313),
    free(22.0, 283.0, 10.382, 1984.0, 0.327),
];

const fn free(displacement: f64, velocity: f64, mass: f64, stiffness: f64, damping: f64) -> FreeVibration {
    FreeVibration { displacement, velocity, mass, stiffness, damping }
}

/// A row of Table 3: what the Monte Carlo varied, and what it found for μ.
#[derive(Debug, Clone, Copy)]
pub struct MonteCarloRow {
    /// The varied parameter.
    pub varied: &'static str,
    /// Mean of μ.
    pub mean: f64,
    /// Standard deviation of μ.
    pub deviation: f64,
    /// Number that is called sensitivity, and the product of the two columns before it.
    pub sensitivity_and_product: Option<[f64; 2]>,
}

/// Table 3.
pub const TABLE_3: [MonteCarloRow; 4] = [
    varied("m", 0.150_015, 6.39e-5, Some([3.12e-7, 1.99e-11])),
    varied("k", 0.150_018, 2.09e-5, Some([2.64e-5, 5.52e-10])),
    varied("c", 0.150_001, 2.36e-4, Some([8.04e-6, 1.90e-9])),
    varied("ALL", 0.150_021, 2.48e-4, None),
];

const fn varied(varied: &'static str, mean: f64, deviation: f64, columns: Option<[f64; 2]>) -> MonteCarloRow {
    MonteCarloRow { varied, mean, deviation, sensitivity_and_product: columns }
}

/// Table 4: initial displacement (mm), then μ and highest velocity (m/s) with linear c, and both with mean c.
pub const TABLE_4: [(f64, [f64; 2], [f64; 2]); 15] = [
    (8.0, [0.217, 0.086], [0.217, 0.086]),
    (9.0, [0.225, 0.100], [0.224, 0.100]),
    (10.0, [0.228, 0.114], [0.228, 0.114]),
    (11.0, [0.232, 0.128], [0.231, 0.128]),
    (12.0, [0.236, 0.141], [0.235, 0.141]),
    (13.0, [0.244, 0.155], [0.239, 0.155]),
    (14.0, [0.247, 0.168], [0.247, 0.168]),
    (15.0, [0.248, 0.182], [0.248, 0.182]),
    (16.0, [0.252, 0.196], [0.252, 0.196]),
    (17.0, [0.254, 0.209], [0.254, 0.209]),
    (18.0, [0.261, 0.223], [0.261, 0.223]),
    (19.0, [0.265, 0.237], [0.265, 0.237]),
    (20.0, [0.264, 0.251], [0.264, 0.251]),
    (21.0, [0.265, 0.265], [0.265, 0.265]),
    (22.0, [0.267, 0.280], [0.267, 0.280]),
];

/// Table 5: initial displacement (mm), highest velocity (m/s), μ0, μ1, α (s/m). The announced row of 13 mm is missing
/// (E28).
pub const TABLE_5: [[f64; 5]; 6] = [
    [10.0, 0.114, 0.210, 0.238, 5.605],
    [11.0, 0.127, 0.216, 0.244, 5.140],
    [12.0, 0.141, 0.217, 0.259, 4.865],
    [14.0, 0.169, 0.223, 0.250, 3.211],
    [15.0, 0.182, 0.220, 0.260, 3.034],
    [16.0, 0.196, 0.228, 0.261, 2.852],
];

/// Damping against velocity, c = slope v + intercept (Eq. 5.5; N s²/m² and N s/m), and its R².
pub const EQUATION_5_5: [f64; 3] = [0.437, 0.2005, 0.997];
/// The instantaneous quadratic damping (N s²/m²) whose equivalent over a cycle is the slope of Eq. 5.5: 3π/8 of it
/// (E23).
pub const INSTANTANEOUS_SLOPE: f64 = EQUATION_5_5[0] * 3.0 * std::f64::consts::PI / 8.0;
/// μ = a vᵇ + c (Eq. 7.2, v in m/s): a, b, c.
pub const EQUATION_7_2: [f64; 3] = [0.311, 0.2116, 0.03148];
/// Normal loads (N): Table 4 by the text, Table 5 by the scripts, Table 3's script, chapter 6, chapter 8.
pub const LOADS: [f64; 5] = [14.0, 0.8771 * 9.81, 7.2, 7.0, 6.67];
