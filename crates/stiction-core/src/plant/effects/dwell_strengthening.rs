//! Friction that grows while the contact rests.

use super::{Effect, EffectFacts, Hook, LevelChange, Memory, Passage, Scale, Shape, Situation};
use crate::friction::elements::contact_age::slide;
use crate::math::exponential::come_about;
use crate::math::scalar::Scalar;
use crate::parameters;
use crate::support::parameter::ParameterSpec;

parameters! {
    /// Parameters of [`DwellStrengthening`].
    pub struct DwellStrengtheningParameters {
        strength: One, "friction gained by a long rest, as a share of friction",
            default Value(0.0), neutral Some(0.0), typical 0.1, bounds 0.0, 10.0;
        time: Time, "time of rest in which it gains most of that, T",
            default Value(1.0), neutral None, typical 1.0, bounds 1e-6, 1e6;
        distance: Position, "distance of slide that wipes it out, l",
            default Value(1e-2), neutral None, typical 1e-2, bounds 1e-12, 1e6;
        window: Position, "displacement within which the contact counts as resting",
            default Value(2e-3), neutral None, typical 2e-3, bounds 1e-12, 1e6;
    }
}

/// Level 1 + a·q; q' = (1 − q)/T at rest, dq/dx = −q/l in a slide.
///
/// After a full slide and a rest of t, q = 1 − exp(−t/T). Rest and slide are told apart by a window
/// of displacement, not by velocity: a contact that rings has not slid. Memory: offset of the
/// anchor, q.
///
/// Neutral: a = 0.
/// Source: Rabinowicz, Proc. Phys. Soc. 71 (1958), that static friction grows with the time of
/// stationary contact; the exponential forms are ours.
#[derive(Debug, Clone)]
pub struct DwellStrengthening<S>(DwellStrengtheningParameters<S>);

const OFFSET: usize = 0;
const STRENGTH: usize = 1;

impl<S: Scalar> Effect<S> for DwellStrengthening<S> {
    const PARAMETERS: &'static [ParameterSpec] = DwellStrengtheningParameters::<f64>::SPECS;
    const HOOKS: &'static [Hook] = &[Hook::FrictionLevel];
    const REMEMBERS: bool = true;
    const FACTS: EffectFacts = EffectFacts {
        summary: "friction grows while the machine rests and falls back once it slides",
        means: "the longer the machine has stood, the harder it starts",
        remedy: "move a little now and then, or raise the compensation after a rest; look for grease \
                 that is squeezed out, or for seals that stick",
        class: "breakaway",
        coordinate: "time of rest before a slide",
        channels: &[],
        look_alikes: &["stribeck", "rate_dependent_breakaway"],
        experiment: "rests of 0.1 to 5 s, each followed by slow and by fast loading",
        plan: "dwells",
        gains: &["strength"],
        shapes: &[
            Shape { parameter: "time", scale: Scale::One, grid: &[0.3, 1.0, 3.0], fitted: true },
            Shape {
                parameter: "distance",
                scale: Scale::Presliding,
                grid: &[2.0, 7.0],
                fitted: true,
            },
            Shape { parameter: "window", scale: Scale::Resting, grid: &[1.0], fitted: true },
        ],
        second: &[],
        law_terms: &[],
        rotary_only: false,
    };

    fn build(values: &[S]) -> Self {
        Self(DwellStrengtheningParameters::from_values(values))
    }

    #[inline(always)]
    fn level(&self, _at: &Situation<S>, memory: &Memory<S>) -> LevelChange<S> {
        LevelChange { friction: self.0.strength * memory[STRENGTH], viscous: S::constant(0.0) }
    }

    #[inline(always)]
    fn remember(&self, memory: &mut Memory<S>, passage: &Passage<S>) {
        let p = &self.0;
        let slid = slide(&mut memory[OFFSET], passage.displacement, p.window);
        let q = memory[STRENGTH];
        memory[STRENGTH] = if slid.re() == 0.0 {
            q - (q - 1.0) * come_about(passage.span / p.time)
        } else {
            q * (-(slid / p.distance)).exp()
        };
    }
}
