"""A page for each law and effect of the catalogue: figure, equation, source, example, numbers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import stiction as st
from stiction import plot
from stiction.catalogue import EffectRecord, LawRecord, ParameterRecord
from stiction.compare.figures import law_figures
from stiction.compare.figures import name_of as law_picture

from .doc_comments import comment_of, escaped
from .effect_figure import effect_figure
from .examples import effect_example, law_example, printed
from .files import written

__all__ = ["effect_page", "effect_picture", "law_page", "write_gallery"]

INTRODUCTION: Final = """\
# Gallery of {what}

{words}

```{{container}} cards
{cards}
```

```{{toctree}}
:hidden:
{pages}
```
"""
LAWS: Final = """\
Every law of the catalogue, drawn alike: left a contact that turns round within its pre-sliding
length, with a loop inside a loop; right its friction while the speed rises and falls, slowly and
fast. Which one you need: [by symptom](../which-law.md), [by measured property](../compare.md)."""
EFFECTS: Final = """\
What a plant may have beside its law, and what a diagnosis looks for. Each figure is what a plant
leaves that lacks the effect, in the experiment that shows it: left over time, right over the
coordinate in which it shows, as a [report](../report.md) draws it. Nothing was fitted: with a fit,
the plant's own numbers take a part of it away."""
CARD: Final = """
````{{figure}} {picture}
:target: {link}
:alt: {alt}

[`{name}`]({page}) {summary}
````
"""


def write_gallery(docs: Path) -> None:
    """Writes both galleries into a copy of the documentation.

    Parameters
    ----------
    docs : Path
        The copy of ``docs``; everything goes into ``gallery`` within.
    """
    place = docs / "gallery"
    pictures = place / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    law_figures(pictures)
    for law in st.laws():
        written(place / "laws" / f"{law.name}.md", law_page(law, docs))
    for effect in st.effects():
        plot.save(effect_figure(effect), pictures / effect_picture(effect.name))
        written(place / "effects" / f"{effect.name}.md", effect_page(effect))
    written(place / "laws.md", _index("laws", LAWS, st.laws()))
    written(place / "effects.md", _index("effects", EFFECTS, st.effects()))


def effect_picture(effect: str) -> str:
    """File of the figure of an effect."""
    return f"effect-{effect.replace('_', '-')}.png"


def law_page(record: LawRecord, docs: Path) -> str:
    """The page of a law, Markdown.

    Parameters
    ----------
    record : LawRecord
    docs : Path
        Where its page of the theory is looked for; a new law may have none yet.
    """
    code = law_example(record)
    theory = f"theory/{record.name.replace('_', '-')}.md"
    more = f"\n[Theory, step by step](../../{theory})\n" if (docs / theory).exists() else ""
    options = "".join(
        f"* `{option.name}`, {option.meaning}: "
        + "; ".join(f"`{choice}` {meaning}" for choice, meaning in option.choices)
        + "\n"
        for option in record.options
    )
    return _page(
        "law",
        record,
        law_picture(record.name),
        code,
        more,
        ("\n## Options\n\n" + options) if options else "",
    )


def effect_page(record: EffectRecord) -> str:
    """The page of an effect, Markdown.

    Parameters
    ----------
    record : EffectRecord
    """
    alike = ", ".join(f"[`{name}`]({name}.md)" for name in record.look_alikes) or "nothing else"
    needs = ", ".join(("input", "position", *record.channels))
    facts = f"""
| | |
|---|---|
| what it means | {escaped(record.means)} |
| what to do | {escaped(record.remedy)} |
| shows in | {escaped(record.coordinate)} |
| looks like | {alike} |
| told apart by | {escaped(record.experiment)} ([`stiction plan`](../../plan.md): `{record.plan}`) |
| channels needed | {needs} |
"""
    return _page("effect", record, effect_picture(record.name), effect_example(record), facts, "")


def _page(
    kind: str,
    record: LawRecord | EffectRecord,
    picture: str,
    code: str,
    facts: str,
    rest: str,
) -> str:
    comment = comment_of(kind, record.name)
    told = f"\n{comment.behaviour}\n" if comment.behaviour else ""
    return f"""\
# `{record.name}`

{escaped(record.summary)[:1].upper()}{escaped(record.summary)[1:]}.
{facts}
![{record.summary}](../pictures/{picture})

## Equation

{comment.equation}
{told}
Source: {escaped(comment.source)}

## Example

```python
{code}```

It prints

```text
{printed(code)}```

## Parameters

{_table(record.parameters)}
{rest}"""


def _table(parameters: Sequence[ParameterRecord]) -> str:
    rows = [
        "| parameter | what it is | unit (rotary; linear) | default | typical | bounds |",
        "|---|---|---|---|---|---|",
    ]
    for each in parameters:
        unit = each.unit if each.unit == each.linear_unit else f"{each.unit}; {each.linear_unit}"
        low, high = each.bounds
        default = f"{each.default:g}" + (f" ({each.default_rule})" if each.default_rule else "")
        rows.append(
            f"| `{each.name}` | {escaped(each.meaning)} | {unit} | {escaped(default)} "
            f"| {each.typical:g} | {low:g} to {high:g} |"
        )
    return "\n".join(rows)


def _index(what: str, words: str, records: Sequence[LawRecord] | Sequence[EffectRecord]) -> str:
    picture = law_picture if what == "laws" else effect_picture
    cards = "".join(
        CARD.format(
            picture=f"pictures/{picture(record.name)}",
            link=f"{what}/{record.name}.html",
            page=f"{what}/{record.name}.md",
            alt=record.summary,
            name=record.name,
            summary=escaped(record.summary),
        )
        for record in records
    )
    pages = "\n".join(f"{what}/{record.name}" for record in records)
    return (
        INTRODUCTION.format(what=what, words=words, cards=cards, pages=pages)
        .replace("```{container}", "``````{container}")
        .replace(f"{cards}\n```", f"{cards}\n``````")
    )
