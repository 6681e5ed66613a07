"""The list of verbs: imported when they are asked for, so that help comes at once.

A verb's module is imported for its help, and imports at its top only what its signature and help
need. What the verb works with is imported where it runs.
"""

from __future__ import annotations

from dataclasses import dataclass

import cyclopts

__all__ = ["VERBS", "Verb", "build"]


@dataclass(frozen=True)
class Verb:
    """A verb of the command line.

    Attributes
    ----------
    name : str
    where : str
        Module of this folder and name in it.
    summary : str
        The first line of its docstring, which is not imported for a list of verbs.
    examples : tuple of (str, str)
        What follows ``stiction``, and what that does.
    """

    name: str
    where: str
    summary: str
    examples: tuple[tuple[str, str], ...]

    @property
    def epilogue(self) -> str:
        """The examples as they stand below the help."""
        lines = [f"  # {meaning}\n  stiction {words}" for words, meaning in self.examples]
        return "\n".join(["Examples:", *lines])


VERBS: tuple[Verb, ...] = (
    Verb(
        "init",
        "init:init",
        "Guess columns and units of recordings; write a commented plant.toml and session.toml.",
        (
            ("init motor.csv -o motor", "drafts of both files, with the reason of each guess"),
            ("init logs/ --joint elbow", "one joint of a robot's logs"),
            ("init arm.urdf logs/ -o arm", "all joints of a robot"),
        ),
    ),
    Verb(
        "demo",
        "demo:demo",
        "Diagnose recordings of a simulated motor in which one physical effect is hidden.",
        (
            ("demo", "a diagnosis from end to end, in stiction-demo/"),
            ("demo --copy mine", "its recordings and session file, to be edited"),
        ),
    ),
    Verb(
        "simulate",
        "simulate:simulate",
        "Simulate the recorded input; where the motion was measured too, show what is wrong.",
        (
            ("simulate plant.toml run.csv", "trajectory, free run and effort residual"),
            (
                'simulate plant.toml run.csv --columns "input=vir [V]"',
                "columns that have other names",
            ),
            ("simulate found/plant.toml session.toml --json", "what a diagnosis has found"),
        ),
    ),
    Verb(
        "fit",
        "fit:fit",
        "Fit the plant of a session to its recordings, or a law to a table of speed and friction.",
        (
            (
                "fit session.toml",
                "parameters with standard errors, error where fitted and held out",
            ),
            ("fit friction.csv --law coulomb", "a law to a table of velocity and torque"),
        ),
    ),
    Verb(
        "diagnose",
        "diagnose:diagnose",
        "Find out what a simulation of the machine is missing, add it and measure the gain.",
        (
            ("diagnose motor.csv --gain 0.12", "a recording of current; 0.12 N·m/A"),
            ("diagnose session.toml --laws all", "every other friction law beside the plant's"),
            ("diagnose session.toml --add new.csv", "one more recording, in seconds"),
        ),
    ),
    Verb(
        "watch",
        "watch:watch",
        "Diagnose the recordings of a folder, and go on when one is added or changed.",
        (
            ("watch logs/ --gain 0.12", "until Ctrl-C"),
            ("watch logs/ --once --quiet", "one look, for a job that runs by the clock"),
        ),
    ),
    Verb(
        "plan",
        "plan:plan",
        "Write input and reference signals with which to record a machine, a figure of each.",
        (
            ("plan plant.toml --position 0.5 --effort 2", "within limits of the machine"),
            ("plan plant.toml --only ramps --rate 500", "one experiment, 500 samples a second"),
        ),
    ),
    Verb(
        "export",
        "export:export",
        "Write a plant for a simulator, a controller or firmware, and say what is lost on the way.",
        (
            ("export plant.toml --to mujoco --to c", "for MuJoCo, and as one C99 file"),
            ("export plant.toml --to urdf --check session.toml", "what it keeps of the gain"),
        ),
    ),
    Verb(
        "import",
        "import_:import_",
        "Make a plant.toml of parameters that another tool has found.",
        (("import params.json -o servo", "of better-actuator-models"),),
    ),
    Verb(
        "compensate",
        "compensate:compensate",
        "Simulate the machine under its controller with a feed-forward of friction, and without.",
        (("compensate plant.toml --session session.toml", "tracking error, before and after"),),
    ),
    Verb(
        "library",
        "library:library",
        "List machines whose friction is known, show one, or compare a unit of yours with it.",
        (
            ("library", "all machines"),
            ("library ur10e_wrist -o wrist", "one of them as a plant.toml"),
            ("library ur10e_wrist --session session.toml", "your unit beside it"),
        ),
    ),
    Verb(
        "laws",
        "catalogue:laws",
        "List the friction laws, or show one with its parameters and options.",
        (("laws", "all laws"), ("laws lugre", "parameters, units, defaults and bounds of one")),
    ),
    Verb(
        "effects",
        "catalogue:effects",
        "List the effects, or show one with its parameters, look-alikes and separating experiment.",
        (("effects", "all effects"), ("effects cogging --json", "one of them, as JSON")),
    ),
    Verb(
        "compare",
        "compare:compare",
        "Compare friction laws by experiment: fifteen properties of each, computed.",
        (
            ("compare lugre dahl coulomb -o laws", "three laws, with figures"),
            ("compare --json", "all of them"),
        ),
    ),
    Verb(
        "paper",
        "paper:paper",
        "Run and draw every experiment of the paper on the illustrative rig, and stick-slip.",
        (("paper -o figures", "Hsieh and Pan, Wear 242 (2000)"),),
    ),
    Verb(
        "bench",
        "bench:bench",
        "Lay out sessions whose truth is hidden, and score anybody's answers to them.",
        (
            ("bench make sessions --number 24", "sessions, and their truth apart"),
            ("bench score sessions answers", "rates with intervals"),
        ),
    ),
    Verb(
        "completion",
        "completion:completion",
        "Print the completion of a shell, or the manual page.",
        (
            ("completion bash > ~/.local/share/bash-completion/completions/stiction", "bash"),
            ("completion zsh > ~/.zfunc/_stiction", "zsh, where fpath has ~/.zfunc"),
            ("completion man > ~/.local/share/man/man1/stiction.1", "man stiction"),
        ),
    ),
)

_ONWARD = "Begin with a recording: stiction diagnose motor.csv. A verb's own help has examples."


def build(wanted: str = "") -> cyclopts.App:
    """The command ``stiction`` with all its verbs, none of which is imported yet.

    Parameters
    ----------
    wanted : str
        Verb whose own docstring is its help, once it is imported; of the others it is the summary.
    """
    app = cyclopts.App(
        name="stiction",
        help="Simulates machines that stick, creep and slip; shows what a simulation gets wrong.",
        version=_version,
        help_format="plaintext",
        help_epilogue=_ONWARD,
        sort_key=None,
    )
    for place, verb in enumerate(VERBS):
        module, _, name = verb.where.partition(":")
        more = {} if name == "bench" else {"help_epilogue": verb.epilogue}
        app.command(
            f"{__package__}.{module}:{name}",
            name=verb.name,
            help=None if verb.name == wanted else verb.summary,
            sort_key=place,
            **more,
        )
    return app


def _version() -> str:
    from .version import version

    return version()
