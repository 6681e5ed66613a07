//! Linear algebra of a step: matrices of a few dozen columns.

use nalgebra::{Cholesky, DMatrix, DVector};

/// Singular values below this share of the greatest one are left alone.
const FLAT: f64 = 1e-14;

/// The solution of a system whose matrix is symmetric and has no negative direction but by rounding.
pub fn solve(matrix: DMatrix<f64>, right: &DVector<f64>) -> DVector<f64> {
    if let Some(factors) = Cholesky::new(matrix.clone()) {
        let found = factors.solve(right);
        if found.iter().all(|value| value.is_finite()) {
            return found;
        }
    }
    // The shortest one; 0 where the matrix holds what is no number.
    let size = matrix.nrows();
    let none = || DVector::zeros(size);
    if matrix.iter().any(|value| !value.is_finite()) {
        return none();
    }
    let parts = matrix.svd(true, true);
    let least = FLAT * parts.singular_values.max();
    parts.solve(right, least).unwrap_or_else(|_| none())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved_also_where_one_direction_is_flat() {
        let right = DVector::from_vec(vec![1.0, 2.0]);
        let found = solve(DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 3.0]), &right);
        assert!((found - DVector::from_vec(vec![1.0 / 11.0, 7.0 / 11.0])).amax() < 1e-15);
        let flat = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 1.0]);
        let found = solve(flat, &DVector::from_vec(vec![2.0, 2.0]));
        assert!((found - DVector::from_vec(vec![1.0, 1.0])).amax() < 1e-12);
        let lost = solve(DMatrix::from_element(1, 1, f64::NAN), &DVector::from_element(1, 1.0));
        assert_eq!(lost[0], 0.0);
    }
}
