"""The diagnosis of a robot: its links, then each joint as a machine of one axis."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from typing import Final

from .. import __version__
from .._support.best_effort import Failure, attempt
from .._support.given import instance, whole
from .._support.products import on_one_thread
from .._support.progress import phase
from .._support.workers import side_by_side, with_workers
from ..catalogue import effects
from ..diagnosis import ALPHA, SMALLEST, SURROGATES, diagnose
from ..diagnosis.findings.result import Diagnosis
from ..errors import NotEnoughData
from ..session import Session
from .agreement import Agreement, agreement_of
from .fit import JointSession, RobotFit, fit_robot
from .result import JointFindings, RobotDiagnosis, folder_names
from .session import RobotSession

__all__ = ["OF_THE_LINKS", "diagnose_robot"]

OF_THE_LINKS: Final = tuple(record.name for record in effects() if record.weighs)
"""Effects that the rigid links hold already: a joint is not asked for them."""

_logger = logging.getLogger(__name__)


@on_one_thread
def diagnose_robot(
    session: RobotSession,
    *,
    without: Sequence[str] = (),
    laws: Sequence[str] = (),
    surrogates: int = SURROGATES,
    smallest: float = SMALLEST,
    alpha: float = ALPHA,
    seed: int = 0,
    threads: int | None = None,
) -> RobotDiagnosis:
    """Find out what a simulation of a robot is missing, joint by joint.

    The links are fitted to all joints together, and each joint is then diagnosed as a machine of
    one axis whose load is what the links need of it along the measured motion: names, gains,
    floors and intervals are those of ``stiction.diagnose``.

    Parameters
    ----------
    session : RobotSession
    without, laws, surrogates, smallest, alpha, seed, threads
        As for ``stiction.diagnose``.

    Returns
    -------
    RobotDiagnosis
        After Ctrl-C the joints that were finished, with ``success`` False.

    Raises
    ------
    InputError
        As for ``stiction.diagnose``, and for ``fit_robot``.
    KeyboardInterrupt
        Ctrl-C before a joint was finished, or for the second time.
    """
    began = time.perf_counter()
    instance(session, RobotSession, "diagnose_robot: session", "what load_session returns")
    threads = None if threads is None else whole(threads, "diagnose_robot: threads", least=1)
    fit = fit_robot(session)
    names = session.robot.names
    folders = folder_names(names)
    sessions = [_session(fit, index) for index in range(len(names))]
    # Joints side by side use the cores better than the recordings of one, so each has one thread.
    alone = len(names) == 1

    def told(index: int) -> tuple[JointFindings, list[Agreement]]:
        name = names[index]
        phase(_logger, "joint %s (%d of %d)", name, index + 1, len(names))
        own = sessions[index]
        if isinstance(own, NotEnoughData):
            sentence = f"These data cannot be tested: {own}."
            untold = Diagnosis("not_testable", sentence, fit.plant(index), version=__version__)
            return JointFindings(name, folders[name], untold), []
        found = diagnose(
            None,
            own.session,
            without=tuple(dict.fromkeys((*without, *OF_THE_LINKS))),
            laws=laws,
            surrogates=surrogates,
            smallest=smallest,
            alpha=alpha,
            seed=seed,
            threads=threads if alone else 1,
        )
        agree = _agreement(name, found, own.session, own.payloads) if found.success else []
        return JointFindings(name, folders[name], found), agree

    joints: list[JointFindings] = []
    agreement: list[Agreement] = []
    success = True
    with with_workers(1 if alone else threads):
        results = side_by_side(told, range(len(names)))
        try:
            for own, agree in results:
                joints.append(own)
                agreement += agree
                success = own.diagnosis.success
                if not success:
                    break
        except KeyboardInterrupt:
            if not joints:
                raise
            success = False
        finally:
            results.close()
    return RobotDiagnosis(
        fit,
        tuple(joints),
        tuple(agreement),
        success,
        __version__,
        seed,
        time.perf_counter() - began,
        fit.session.assumed,
    )


def _session(fit: RobotFit, joint: int) -> JointSession | NotEnoughData:
    """A joint as a session of one axis, or why it is none."""
    try:
        return fit.joint(joint)
    except NotEnoughData as error:
        return error


def _agreement(
    name: str, found: Diagnosis, session: Session, payloads: Sequence[float]
) -> list[Agreement]:
    if found.extended is None or len(session) < 2:
        return []
    made = attempt(
        f"the agreement of {name}", lambda: agreement_of(name, found.plant, session, payloads)
    )
    return [] if isinstance(made, Failure) else made
