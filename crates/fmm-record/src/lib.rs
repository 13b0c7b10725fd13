//! Uniformly sampled measured records with quantity and unit: readers for CSV and MATLAB files, conditioning, peaks, calculus.
