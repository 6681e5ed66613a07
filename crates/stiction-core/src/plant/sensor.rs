//! Sensor: what a recording shows of the position.

/// Position sensor with a resolution.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sensor {
    /// Size of a count; 0 means continuous.
    pub count: f64,
}

impl Sensor {
    /// The reading at a position: the nearest count.
    #[inline]
    pub fn read(&self, position: f64) -> f64 {
        if self.count > 0.0 { (position / self.count).round() * self.count } else { position }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_are_within_half_a_count() {
        let sensor = Sensor { count: 3.9e-6 };
        for x in [-1.0, 0.0, 1.95e-6, 0.123_456] {
            assert!((sensor.read(x) - x).abs() <= 0.5 * 3.9e-6 * (1.0 + 1e-9));
        }
        assert_eq!(Sensor::default().read(0.1234), 0.1234);
    }
}
