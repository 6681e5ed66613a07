"""The form of an answer: the part of findings.json that is scored."""

from __future__ import annotations

import json
from typing import Any, Final

__all__ = ["BENCH_FORMAT", "SCHEMA", "SCHEMA_TEXT", "VERDICTS"]

BENCH_FORMAT: Final = "stiction-bench 1"

VERDICTS: Final = {
    "nothing_missing": "the plant lacks nothing that the data show; no effects",
    "missing_effect": "every effect that is told is decided, and there is one at least",
    "ambiguous": "something is missing, and an effect at least is not decided",
    "unexplained": "something is missing that the effects told, if any, do not explain",
    "not_testable": "the data do not suffice for an answer; no effects",
}
"""What an answer may be, and what each means."""

_NAMES: Final = {"type": "array", "items": {"type": "string"}}
SCHEMA: Final[dict[str, Any]] = {
    "$schema": "https://json-schema.org/draft/2020-12/schema",
    "title": "Answer to one session of a stiction bench",
    "description": "A findings.json of stiction diagnose is one as well: it has a key schema.",
    "type": "object",
    "required": ["verdict", "effects"],
    "additionalProperties": False,
    "properties": {
        "verdict": {"oneOf": [{"const": k, "description": v} for k, v in VERDICTS.items()]},
        "effects": {
            "type": "array",
            "description": "Likeliest first. Names are those of `stiction effects`.",
            "items": {
                "type": "object",
                "required": ["name", "decided"],
                "additionalProperties": False,
                "properties": {
                    "name": {"type": "string"},
                    "decided": {
                        "type": "boolean",
                        "description": "true: told without reserve; false: one of several",
                    },
                    "probability": {
                        "type": "number",
                        "minimum": 0,
                        "maximum": 1,
                        "description": "that this effect is missing from the plant",
                    },
                    "look_alikes": {**_NAMES, "description": "explain the data about as well"},
                    "parameters": {
                        "type": "object",
                        "description": "numbers by name, for readers; they are not scored",
                        "additionalProperties": {"type": "number"},
                    },
                },
            },
        },
        "seconds": {"type": "number", "minimum": 0, "description": "that it took; not scored"},
    },
}
"""JSON Schema of an answer; ``read`` checks by the same rules, in sentences."""
SCHEMA_TEXT: Final = json.dumps(SCHEMA, indent=2) + "\n"
