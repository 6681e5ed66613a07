"""Functions by which pickled objects come back; their names are part of the pickle."""

from __future__ import annotations

from typing import Any

from ._native import FrictionModel
from .motor import Motor


def friction_model(law: str, keywords: dict[str, Any], state: dict[str, Any]) -> FrictionModel:
    """A friction model with these keywords, in this state."""
    model = FrictionModel(law, **keywords)
    model.state = state
    return model


def motor(
    settings: dict[str, Any], law: str, keywords: dict[str, Any], state: dict[str, Any]
) -> Motor:
    """A motor with these settings and this friction, in this state."""
    rebuilt = Motor(friction=FrictionModel(law, **keywords), **settings)
    rebuilt.state = state
    return rebuilt
