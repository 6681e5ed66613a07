"""Orders of waves: which of them a stroke determines."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from ...fitting.result import FitParameter
from .candidates import Scales

__all__ = ["open_orders", "order_words"]


def open_orders(parameters: Mapping[str, FitParameter], scales: Scales) -> dict[str, FitParameter]:
    """The parameters with orders below one period over the range of motion left open.

    Of less than a period a stroke shows a bend, and waves of many lengths have that bend.
    """
    if scales.whole_turns or len(scales.orders) < 2:
        return dict(parameters)
    # Orders are tried in steps of half a period over the range.
    once = scales.orders[1]
    return {
        path: replace(p, stderr=math.inf, ci95=(-math.inf, math.inf))
        if _is_order(path) and p.value < once
        else p
        for path, p in parameters.items()
    }


def order_words(path: str, parameter: FitParameter) -> str:
    """An order that is open, in words; "" for any other parameter."""
    if not _is_order(path) or math.isfinite(parameter.ci95[1]):
        return ""
    return (
        f"{path.rsplit('.', 1)[-1]} not determined: less than one period over the range of motion"
    )


def _is_order(path: str) -> bool:
    return path.startswith("effects.") and path.rsplit(".", 1)[-1] in ("order", "order_2")
