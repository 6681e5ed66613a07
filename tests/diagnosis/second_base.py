"""A diagnosis whose second base, that of another law, comes to nothing."""

from typing import Any

import pytest

from stiction.diagnosis import pipeline


def fail_the_second_base(monkeypatch: pytest.MonkeyPatch, fault: BaseException) -> list[Any]:
    """Raise a fault in place of every base but the first; what each was asked with."""
    whole, begun = pipeline.fit_baseline, []

    def based(*given: Any) -> Any:
        begun.append(given)
        if len(begun) > 1:
            raise fault
        return whole(*given)

    monkeypatch.setattr(pipeline, "fit_baseline", based)
    return begun
