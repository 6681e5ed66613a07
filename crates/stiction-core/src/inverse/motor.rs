//! What a motor in plain numbers makes of a given motion.

use super::follow::{Efforts, SeesAbout};
use super::kernel::RowKernel;
use super::shoot::{Pull, Windows};
use crate::simulate::motor::Motor;
use crate::support::error::{Error, Result};
use crate::support::motion::MeasuredMotion;

impl Motor {
    /// Efforts along given positions, one more than there are samples: of the drive, of gravity and
    /// added efforts, and friction; then how far the centre of mass is ahead of the reading. Each is
    /// as long as there are samples, and about the end of each (see `Running::follow_about`).
    pub fn follow(&mut self, motion: &MeasuredMotion<'_>, efforts: [&mut [f64]; 4]) -> Result<()> {
        motion.check()?;
        let wanted = motion.samples();
        let [driven, ambient, friction, ahead] = efforts;
        for array in [&driven, &ambient, &friction, &ahead] {
            if array.len() != wanted {
                let name = "out".to_owned();
                return Err(Error::Length { name, given: array.len(), wanted });
            }
        }
        self.running.follow_about(motion, &mut EffortRows([driven, ambient, friction, ahead]));
        Ok(())
    }

    /// Measured minus needed effort along given positions, seen through a kernel: all of an effort
    /// residual but the load and the inertia term of what the sensor shows.
    pub fn follow_rows(
        &mut self,
        motion: &MeasuredMotion<'_>,
        kernel: &RowKernel<'_>,
    ) -> Result<Vec<f64>> {
        motion.check()?;
        let mut efforts = [(); 4].map(|()| vec![0.0; motion.samples()]);
        let places = efforts.each_mut().map(Vec::as_mut_slice);
        self.running.follow_about(motion, &mut EffortRows(places));
        let [driven, ambient, mut needed, ahead] = efforts;
        needed.iter_mut().zip(&ambient).for_each(|(friction, ambient)| *friction -= ambient);
        let mut rows = vec![0.0; kernel.rows(motion.samples())];
        kernel.column([&needed, &driven, &ahead], &mut rows);
        Ok(rows)
    }

    /// What each window along given positions comes to (see `Running::shoot`).
    pub fn shoot(
        &mut self,
        motion: &MeasuredMotion<'_>,
        windows: &Windows<'_>,
    ) -> Result<Vec<f64>> {
        let mut sums = Vec::with_capacity(windows.number(motion.samples()));
        let shot = self.running.shoot(motion, windows, |_| 0.0, &mut |_, sum| sums.push(sum));
        shot.map_err(|error| self.spec.blame(error))?;
        Ok(sums)
    }

    /// Readings and pulls of a run that is drawn to given positions (see `Running::accompany`).
    pub fn accompany(
        &mut self,
        motion: &MeasuredMotion<'_>,
        pull: Pull,
    ) -> Result<(Vec<f64>, Vec<f64>)> {
        let mut rows = (Vec::new(), Vec::new());
        let went = self.running.accompany(motion, pull, |_, reading, effort| {
            rows.0.push(reading);
            rows.1.push(effort);
        });
        went.map_err(|error| self.spec.blame(error))?;
        Ok(rows)
    }
}

/// Rows of the efforts of the drive, of gravity and added efforts, of friction and of how far the
/// centre of mass is ahead.
struct EffortRows<'a>([&'a mut [f64]; 4]);

impl SeesAbout<f64> for EffortRows<'_> {
    #[inline(always)]
    fn see(&mut self, k: usize, efforts: &Efforts<f64>) {
        let Efforts { driven, ambient, friction, ahead, .. } = *efforts;
        for (row, value) in self.0.iter_mut().zip([driven, ambient, friction, ahead]) {
            row[k] = value;
        }
    }
}
