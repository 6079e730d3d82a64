"""A plan of two tasks to look at."""

from __future__ import annotations

from pathlib import Path

import pytest

from mmplan.pipeline import solve
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.visualization.exhibit import Exhibit, exhibit_of_plan
from tests.tabletop import two_tasks


@pytest.fixture(scope="session")
def problem() -> Problem:
    return two_tasks()


@pytest.fixture(scope="session")
def plan(problem: Problem) -> Plan:
    return solve(problem, seed=3)


@pytest.fixture(scope="session")
def plan_file(plan: Plan, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("plan") / "plan.json"
    plan.save(path)
    return path


@pytest.fixture(scope="session")
def exhibit(problem: Problem, plan: Plan) -> Exhibit:
    return exhibit_of_plan(problem, plan)
