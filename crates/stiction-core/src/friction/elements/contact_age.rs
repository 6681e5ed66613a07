//! Rest and slide of a contact, told apart by a window of displacement.
//!
//! An anchor is dragged behind the body with a play of ± window. While it stands the contact rests,
//! however the body rings inside the window; what it moves is distance slid.

use crate::math::scalar::Scalar;

/// Moves the anchor after a displacement of the body and gives the distance slid; `offset` is that
/// of the anchor from the body.
#[inline]
pub fn slide<S: Scalar>(offset: &mut S, displacement: S, window: S) -> S {
    let left_behind = *offset - displacement;
    let dragged = if left_behind.re() > window.re() {
        window
    } else if left_behind.re() < -window.re() {
        -window
    } else {
        left_behind
    };
    *offset = dragged;
    (dragged - left_behind).abs()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn motion_inside_the_window_is_rest_and_beyond_it_slide() {
        let mut offset = 0.0;
        let mut slid = |displacement: f64| slide(&mut offset, displacement, 1.0);
        for (displacement, distance) in
            [(0.9, 0.0), (-1.8, 0.0), (1.8, 0.0), (0.6, 0.5), (2.0, 2.0), (-2.0, 0.0), (-0.5, 0.5)]
        {
            assert!((slid(displacement) - distance).abs() < 1e-12, "{displacement}");
        }
    }
}
