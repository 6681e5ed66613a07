"""Experiments on the illustrative rig, run once."""

from __future__ import annotations

import pytest

from stiction import paper


@pytest.fixture(scope="session")
def experiment_1():
    return paper.experiment_1()


@pytest.fixture(scope="session")
def experiment_2():
    return paper.experiment_2()


@pytest.fixture(scope="session")
def experiment_3():
    return paper.experiment_3()


@pytest.fixture(scope="session")
def static_1():
    return paper.static_test(1)


@pytest.fixture(scope="session")
def static_1_stepped():
    return paper.static_test(1, driven="staircase")
