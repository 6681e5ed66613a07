"""Every effect of the reference plant by name."""

from __future__ import annotations

from . import (
    contact_effect_reference,
    drive_effect_reference,
    effect_reference,
    foreign_effect_reference,
    memory_effect_reference,
)

# Those that the product's library has, or shall have.
LIBRARY = {
    "stribeck": effect_reference.Stribeck,
    "viscous_quadratic": effect_reference.ViscousQuadratic,
    "direction_asymmetry": effect_reference.DirectionAsymmetry,
    "torque_bias": effect_reference.TorqueBias,
    "position_dependent_friction": effect_reference.PositionDependentFriction,
    "cogging": effect_reference.Cogging,
    "torque_constant_ripple": effect_reference.TorqueConstantRipple,
    "drive_deadband": effect_reference.DriveDeadband,
    "input_delay": memory_effect_reference.InputDelay,
    "dwell_strengthening": memory_effect_reference.DwellStrengthening,
    "rate_dependent_breakaway": memory_effect_reference.RateDependentBreakaway,
    "warm_up": memory_effect_reference.WarmUp,
    "run_in": memory_effect_reference.RunIn,
    "shaft_compliance": memory_effect_reference.ShaftCompliance,
    "encoder_eccentricity": memory_effect_reference.EncoderEccentricity,
    "creep_hardening": memory_effect_reference.CreepHardening,
    "gravity_unbalance": drive_effect_reference.GravityUnbalance,
    "torque_constant_saturation": drive_effect_reference.TorqueConstantSaturation,
    "drive_saturation": drive_effect_reference.DriveSaturation,
    "back_emf": drive_effect_reference.BackEmf,
    "voltage_limit": drive_effect_reference.VoltageLimit,
    "current_loop_lag": drive_effect_reference.CurrentLoopLag,
    "frictional_lag": drive_effect_reference.FrictionalLag,
    "reverse_point_memory": contact_effect_reference.ReversePointMemory,
    "relaxation": contact_effect_reference.Relaxation,
    "temperature_dependent_friction": contact_effect_reference.TemperatureDependentFriction,
    "load_dependent_friction": contact_effect_reference.LoadDependentFriction,
    "backlash": contact_effect_reference.Backlash,
}
# Those that no library has.
FOREIGN = {
    "acceleration_friction": foreign_effect_reference.AccelerationFriction,
    "stick_patch": foreign_effect_reference.StickPatch,
    "torque_bursts": foreign_effect_reference.TorqueBursts,
    "half_turn_asymmetry": foreign_effect_reference.HalfTurnAsymmetry,
    "root_speed_drag": foreign_effect_reference.RootSpeedDrag,
    "wandering_bias": foreign_effect_reference.WanderingBias,
    "mains_ripple": foreign_effect_reference.MainsRipple,
}
EFFECTS = LIBRARY | FOREIGN
