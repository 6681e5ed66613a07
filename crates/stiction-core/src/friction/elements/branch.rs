//! Where a spring gets along the branch on which it is.

use stiction_dispatch::alone;

use crate::math::scalar::{SECOND, SHORT, Scalar, gone_share};

/// Where a spring is, without its memory.
#[derive(Debug, Clone, Copy)]
pub struct Here<S> {
    /// Elongation.
    pub position: S,
    /// Force.
    pub force: S,
    /// Stiffness.
    pub slope: S,
    /// Direction of the last motion: −1, 1, or 0 before any.
    pub direction: f64,
    /// Steps since the force was last evaluated from a reverse point.
    pub steps: u32,
}

/// The branch on which a spring is.
#[derive(Debug, Clone, Copy)]
pub struct Branch {
    /// The first loading, before any reversal.
    pub first: bool,
    /// Elongation at its reverse point; 0 for the first loading.
    pub origin: f64,
    /// Elongation at which it closes its loop.
    pub target: f64,
}

/// The slope towards which that of a branch fades exponentially, and over which way.
#[derive(Debug, Clone, Copy)]
pub struct Fading<S> {
    /// Elongation at which the branch closes its loop.
    pub target: f64,
    /// The last slope.
    pub last: S,
    /// Share of the distance over which it fades, per displacement.
    pub share: S,
}

impl<S: Scalar> Here<S> {
    /// The same for whoever writes it to memory: numbers that lie side by side there the compiler would
    /// keep in one vector all along the loop.
    #[inline(always)]
    pub fn apart(&self) -> Self {
        let [position, force, slope] = [self.position, self.force, self.slope].map(S::alone);
        Self { position, force, slope, ..*self }
    }

    /// Whether a motion, as a share of the distance over which the branch fades, neither turns round nor
    /// closes the loop; false before any motion, where the target is no number.
    #[inline(always)]
    pub fn stays(&self, branch: &Fading<S>, position: f64, share: f64) -> bool {
        share >= 0.0 && self.direction * (position - branch.target) < 0.0
    }

    /// Such a motion where it is a short one.
    #[inline(always)]
    pub fn onward(&self, branch: &Fading<S>, displacement: S) -> Option<Self> {
        let (position, z) = self.reach(branch, displacement);
        if !self.is_short(z) || !self.stays(branch, position.re(), z.re()) {
            return None;
        }
        Some(self.shortly(branch, displacement, position, z))
    }

    /// Where a motion leads, and as which share of the distance over which the branch fades.
    #[inline(always)]
    pub fn reach(&self, branch: &Fading<S>, displacement: S) -> (S, S) {
        (self.position + displacement, displacement * branch.share)
    }

    /// Whether such a share is a short way that may go on from the step before.
    #[inline(always)]
    pub fn is_short(&self, share: S) -> bool {
        share.re() < SHORT && self.steps < SYNCHRONISED
    }

    /// A short motion that stays on the branch, and where it leads.
    #[inline(always)]
    pub fn shortly(&self, branch: &Fading<S>, displacement: S, position: S, z: S) -> Self {
        let excess = self.slope - branch.last;
        let (way, along) = (displacement.re(), z.re());
        let [force, slope] =
            short_way(self.force.re(), self.slope.re(), excess.re(), way, along, alone);
        // The same, with fewer products of rows of derivatives.
        let share = gone_share(z);
        let gained = displacement * (branch.last + excess * share);
        Self {
            position,
            force: (self.force + gained).with_value(force),
            slope: (self.slope - excess * (z * share)).with_value(slope),
            direction: self.direction,
            // A spring that is held changes no bit, however long.
            steps: self.steps + u32::from(way != 0.0),
        }
    }
}

/// Steps of a spring that go on from the one before until it is evaluated from its reverse point
/// again. Each adds at most 1.5 units in the last place of the force and of the slope, together
/// below 1e-13 of them.
pub const SYNCHRONISED: u32 = 256;

/// Force and slope a short way further along a branch that is `excess` steeper than its end, z·d_0
/// being the way at full size: F + δ·(k − E·z·φ₂) and k − E·z·(1 − z·φ₂), to 4e-14 of what they gain,
/// summed so that as little as can be waits for the displacement. `kept` is [`alone`] for one spring
/// and nothing for springs side by side.
#[inline(always)]
pub fn short_way(
    force: f64,
    slope: f64,
    excess: f64,
    displacement: f64,
    z: f64,
    kept: impl Fn(f64) -> f64,
) -> [f64; 2] {
    let (near, far) = (kept(SECOND[0] + SECOND[1] * z), SECOND[2] + SECOND[3] * z);
    let square = z * z;
    let bent = (excess * displacement) * z;
    let fallen = excess * z;
    let eased = fallen * z;
    [
        kept(((force + displacement * slope) - kept(bent * near)) - (bent * square) * far),
        kept(((slope - fallen) + kept(eased * near)) + (eased * square) * far),
    ]
}
