"""Model descriptions of an FMU, in the words of FMI 2.0 and of FMI 3.0."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import dataclass
from typing import Final

from .. import __version__

__all__ = ["IDENTIFIER", "Described", "Variable", "build_description", "fmi2", "fmi3"]

IDENTIFIER: Final = "plant"
"""What binaries and sources are called."""
INDICATORS: Final = ("event_indicator", "fall_indicator")
UNITS: Final[dict[str, dict[str, float]]] = {
    "rad": {"rad": 1},
    "rad/s": {"rad": 1, "s": -1},
    "rad/s2": {"rad": 1, "s": -2},
    "m": {"m": 1},
    "m/s": {"m": 1, "s": -1},
    "m/s2": {"m": 1, "s": -2},
    "N.m": {"kg": 1, "m": 2, "s": -2},
    "N.m/s": {"kg": 1, "m": 2, "s": -3},
    "N": {"kg": 1, "m": 1, "s": -2},
    "N/s": {"kg": 1, "m": 1, "s": -3},
    "A": {"A": 1},
    "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
    "degC": {"K": 1, "offset": 273.15},
    "s": {"s": 1},
}


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU.

    Attributes
    ----------
    name, unit, description : str
        A unit of "" is that of a truth value.
    reference : int
    causality : str
    start : float or None
        None of what is computed.
    of : str
        Of a derivative, whose it is.
    by : tuple of str
        Variables that it goes by.
    """

    name: str
    reference: int
    causality: str
    unit: str
    description: str
    start: float | None = None
    of: str = ""
    by: tuple[str, ...] = ()


@dataclass(frozen=True)
class Described:
    """What both descriptions say.

    Attributes
    ----------
    name, token, description : str
    variables : tuple of Variable
    exchanges : bool
        Whether there is model exchange.
    """

    name: str
    token: str
    description: str
    variables: tuple[Variable, ...]
    exchanges: bool

    def by(self, each: Variable) -> tuple[Variable, ...]:
        """What a variable of model exchange goes by, in the order of all variables."""
        there = self.exchanges and each.by
        return tuple(other for other in self.variables if there and other.name in each.by)

    def index(self, name: str) -> int:
        """Place of a variable, from 1 on."""
        return 1 + [each.name for each in self.variables].index(name)

    @property
    def outputs(self) -> tuple[Variable, ...]:
        """What is given out."""
        return tuple(each for each in self.variables if each.causality == "output")

    @property
    def derivatives(self) -> tuple[Variable, ...]:
        """Of the states, where there is model exchange."""
        return tuple(each for each in self.variables if each.of and self.exchanges)

    @property
    def unknown(self) -> tuple[Variable, ...]:
        """Outputs and derivatives that have no start."""
        found = (*self.outputs, *self.derivatives)
        return tuple(dict.fromkeys(each for each in found if each.start is None))


def fmi3(of: Described) -> str:
    """modelDescription.xml of FMI 3.0."""
    root = ET.Element("fmiModelDescription", _head(of, "3.0", "instantiationToken"))
    state = {"canGetAndSetFMUState": "true", "canSerializeFMUState": "true"}
    _interfaces(root, of, state, sources=False)
    _units(root, of)
    _log_categories(root)
    _experiment(root)
    references = {each.name: str(each.reference) for each in of.variables}
    variables = ET.SubElement(root, "ModelVariables")
    for each in of.variables:
        own = {"name": each.name, "valueReference": str(each.reference)}
        own |= {"description": each.description, "causality": each.causality}
        own["variability"] = "continuous" if each.unit else "discrete"
        if each.causality in ("output", "local"):
            own["initial"] = "calculated" if each.start is None else "exact"
        if each.unit:
            own["unit"] = each.unit
        if each.of and of.exchanges:
            own["derivative"] = references[each.of]
        if each.start is not None:
            own["start"] = repr(each.start) if each.unit else str(bool(each.start)).lower()
        ET.SubElement(variables, "Float64" if each.unit else "Boolean", own)
    structure = ET.SubElement(root, "ModelStructure")

    def add(tag: str, each: Variable) -> None:
        own = {"valueReference": str(each.reference)}
        if of.by(each):
            own["dependencies"] = " ".join(str(other.reference) for other in of.by(each))
        ET.SubElement(structure, tag, own)

    lists = [("Output", of.outputs), ("ContinuousStateDerivative", of.derivatives)]
    lists.append(("InitialUnknown", of.unknown))
    for tag, listed in lists:
        for each in listed:
            add(tag, each)
    for each in of.variables:
        if each.name in INDICATORS:
            add("EventIndicator", each)
    return _text(root)


def fmi2(of: Described) -> str:
    """modelDescription.xml of FMI 2.0."""
    head = _head(of, "2.0", "guid")
    if of.exchanges:
        number = sum(each.name in INDICATORS for each in of.variables)
        head["numberOfEventIndicators"] = str(number)
    root = ET.Element("fmiModelDescription", head)
    state = {"canGetAndSetFMUstate": "true", "canSerializeFMUstate": "true"}
    _interfaces(root, of, state, sources=True)
    _units(root, of)
    _log_categories(root)
    _experiment(root)
    variables = ET.SubElement(root, "ModelVariables")
    for each in of.variables:
        own = {"name": each.name, "valueReference": str(each.reference)}
        own |= {"description": each.description, "causality": each.causality}
        own["variability"] = "continuous" if each.unit else "discrete"
        if each.causality in ("output", "local"):
            own["initial"] = "calculated" if each.start is None else "exact"
        scalar = ET.SubElement(variables, "ScalarVariable", own)
        value: dict[str, str] = {"unit": each.unit} if each.unit else {}
        if each.of and of.exchanges:
            value["derivative"] = str(of.index(each.of))
        if each.start is not None:
            value["start"] = repr(each.start) if each.unit else str(bool(each.start)).lower()
        ET.SubElement(scalar, "Real" if each.unit else "Boolean", value)
    structure = ET.SubElement(root, "ModelStructure")
    lists = [("Outputs", of.outputs), ("Derivatives", of.derivatives)]
    lists.append(("InitialUnknowns", of.unknown))
    for tag, listed in lists:
        if listed:
            inside = ET.SubElement(structure, tag)
            for each in sorted(listed, key=lambda each: of.index(each.name)):
                own = {"index": str(of.index(each.name))}
                if of.by(each):
                    places = [str(of.index(other.name)) for other in of.by(each)]
                    own["dependencies"] = " ".join(places)
                ET.SubElement(inside, "Unknown", own)
    return _text(root)


def build_description() -> str:
    """sources/buildDescription.xml of FMI 3.0: how other platforms get their binary."""
    root = ET.Element("fmiBuildDescription", {"fmiVersion": "3.0"})
    own = ET.SubElement(root, "BuildConfiguration", {"modelIdentifier": IDENTIFIER})
    files = ET.SubElement(own, "SourceFileSet", {"language": "C99"})
    ET.SubElement(files, "SourceFile", {"name": f"{IDENTIFIER}.c"})
    return _text(root)


def _head(of: Described, version: str, token: str) -> dict[str, str]:
    return {
        "fmiVersion": version,
        "modelName": of.name,
        token: of.token,
        "description": of.description,
        "generationTool": f"stiction {__version__}",
        "variableNamingConvention": "flat",
    }


def _interfaces(root: ET.Element, of: Described, state: dict[str, str], *, sources: bool) -> None:
    own = {"modelIdentifier": IDENTIFIER, **state}
    step = {"canHandleVariableCommunicationStepSize": "true"}
    found = [ET.SubElement(root, "ModelExchange", own)] if of.exchanges else []
    found.append(ET.SubElement(root, "CoSimulation", own | step))
    for each in found:
        if each.tag == "ModelExchange":
            each.set(f"providesDirectionalDerivative{'' if sources else 's'}", "true")
        if each.tag == "ModelExchange" and not sources:
            each.set("needsCompletedIntegratorStep", "true")
        if sources:
            files = ET.SubElement(each, "SourceFiles")
            ET.SubElement(files, "File", {"name": f"{IDENTIFIER}.c"})


def _units(root: ET.Element, of: Described) -> None:
    units = ET.SubElement(root, "UnitDefinitions")
    for name in dict.fromkeys(each.unit for each in of.variables if each.unit):
        unit = ET.SubElement(units, "Unit", {"name": name})
        ET.SubElement(unit, "BaseUnit", {key: f"{power:g}" for key, power in UNITS[name].items()})


def _log_categories(root: ET.Element) -> None:
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", {"name": "logStatusError"})


def _experiment(root: ET.Element) -> None:
    ET.SubElement(
        root, "DefaultExperiment", {"startTime": "0", "stopTime": "1", "stepSize": "1e-3"}
    )


def _text(root: ET.Element) -> str:
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, "unicode") + "\n"
