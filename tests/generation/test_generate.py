"""Generated problems: the same from the same seed, sound, and as hard as asked for."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mmplan.collision import CollisionWorld, clearances
from mmplan.exceptions import InputError, NoPlanError
from mmplan.generation import (
    FAMILIES,
    Difficulty,
    GeneratedScene,
    generate,
    has_candidate,
)
from mmplan.generation.acceptance import found_by
from mmplan.problem import Problem
from mmplan.scene_file import load_problem

SEEDS = range(2)
DIALS = (0.0, 0.5, 1.0)
EXACT = 1e-6  # m


def anything(_problem: Problem) -> bool:
    return True


def nothing(_problem: Problem) -> bool:
    return False


def drawn(
    family: str, count: int, seed: int = 0, difficulty: float = 0.5
) -> list[GeneratedScene]:
    """Scenes that need not be solvable, as they are quick to draw."""
    return list(generate(family, count, seed, difficulty, accept=anything))


@pytest.fixture(scope="module")
def scenes() -> list[GeneratedScene]:
    """Scenes of every family, over seeds and difficulties."""

    def all_kinds() -> Iterator[GeneratedScene]:
        for family, seed, dial in product(FAMILIES, SEEDS, DIALS):
            yield from drawn(family, 1, seed, dial)

    return list(all_kinds())


@pytest.mark.parametrize("family", FAMILIES)
def test_the_same_arguments_give_the_same_text(family: str) -> None:
    (first,), (again,) = drawn(family, 1), drawn(family, 1)
    assert first.text == again.text
    assert first.name == again.name


def test_a_smaller_count_gives_the_first_scenes() -> None:
    assert [s.text for s in drawn("bin", 3)][:1] == [s.text for s in drawn("bin", 1)]


def test_seeds_and_indices_give_different_scenes() -> None:
    texts = [s.text for seed in SEEDS for s in drawn("table", 2, seed)]
    bodies = {text.split("robot:")[1] for text in texts}
    assert len(bodies) == len(texts)


def test_every_scene_loads_from_its_file(
    scenes: list[GeneratedScene], tmp_path: Path
) -> None:
    for scene in scenes[::5]:
        path = tmp_path / scene.file_name
        path.write_text(scene.text)
        problem = load_problem(path)
        assert problem.name == scene.name
        assert problem.fingerprint == scene.problem.fingerprint


def test_objects_stand_exactly_on_one_support(scenes: list[GeneratedScene]) -> None:
    for scene in scenes:
        problem = scene.problem
        task = problem.tasks[0]
        scenery = CollisionWorld.of_problem(problem).scenery
        item = problem.object(task.object)
        for T in (item.T_world_object, task.T_world_goal):
            near = clearances(scenery, task.object, T, 0.002)
            assert len(near) == 1, scene.name
            assert abs(next(iter(near.values()))) <= EXACT, scene.name


def test_no_obstacle_hangs_in_the_air(scenes: list[GeneratedScene]) -> None:
    """Each touches the floor, or something that does, and so on."""
    for scene in scenes[::3]:
        assert floating(scene.problem) == set(), scene.name


def floating(problem: Problem) -> set[str]:
    """The obstacles that no chain of contacts joins to the floor or a wall."""
    world = CollisionWorld.of_problem(problem)
    bodies = [
        (world.owner_of(i), body)
        for i, body in enumerate(world.geometry.geometryObjects)
        if world.owner_of(i) in {o.name for o in problem.obstacles}
    ]
    boxes = {name: bounds(body) for name, body in bodies}
    held = {name for name in boxes if name == "floor"}
    while True:
        more = {
            name
            for name, (low, high) in boxes.items()
            if name not in held
            and any(
                np.all(low <= boxes[h][1] + EXACT)
                and np.all(high >= boxes[h][0] - EXACT)
                for h in held
            )
        }
        if not more:
            return set(boxes) - held
        held |= more


def bounds(body: object) -> tuple[np.ndarray, np.ndarray]:
    """The corners of a body's bounding box in the world; bodies stand upright."""
    geometry, placement = body.geometry, body.placement  # type: ignore[attr-defined]
    geometry.computeLocalAABB()
    box = geometry.aabb_local
    half = np.abs(placement.rotation) @ ((box.max_ - box.min_) / 2)
    middle = placement.rotation @ ((box.max_ + box.min_) / 2) + placement.translation
    return middle - half, middle + half


@pytest.mark.parametrize("family", FAMILIES)
def test_more_difficult_is_more_cluttered(family: str) -> None:
    def clutter(dial: float) -> int:
        drafts = (
            FAMILIES[family](np.random.default_rng(seed), Difficulty(dial))
            for seed in range(20)
        )
        return sum(draft.clutter for draft in drafts if draft is not None)

    counts = [clutter(dial) for dial in np.linspace(0.0, 1.0, 5)]
    assert counts == sorted(set(counts))


@pytest.mark.parametrize("family", FAMILIES)
def test_easy_problems_are_solvable_by_a_small_search(family: str) -> None:
    def quickly(problem: Problem) -> bool:
        return found_by(problem, "random", evaluations=600, seed=0)

    (scene,) = generate(family, 1, seed=5, difficulty=0.0, accept=quickly)
    assert scene.rejected <= 1


def test_what_has_no_room_for_the_base_has_no_candidate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("mmplan.optimizers.bases._MAX_DRAWS", 3)
    problem = drawn("bin", 1)[0].problem
    nowhere = np.tile(problem.q_start[:2, None], 2)  # far from both bins
    assert not has_candidate(replace(problem, base_bounds=nowhere))


def test_the_head_says_what_made_the_scene() -> None:
    head = drawn("shelf", 2, 7, 0.25)[1].text.splitlines()[0]
    assert head == (
        "# Generated by mmplan generate: family shelf, seed 7, index 1, difficulty 0.25"
    )


def test_rejected_scenes_are_counted_and_drawn_anew() -> None:
    asked: list[str] = []

    def third(problem: Problem) -> bool:
        asked.append(problem.fingerprint)
        return len(asked) == 3

    (scene,) = generate("table", 1, accept=third)
    assert scene.rejected >= 2
    assert len(set(asked)) == 3
    assert scene.problem.fingerprint == asked[-1]


def test_a_scene_is_given_up_at_last(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mmplan.generation.generator.MOST_DRAWS", 2)
    with pytest.raises(NoPlanError, match="none of the 2 scenes drawn"):
        next(generate("bin", 1, accept=nothing))


@pytest.mark.parametrize("value", [-0.1, 1.5, float("nan"), float("inf")])
def test_a_difficulty_off_the_dial_is_refused(value: float) -> None:
    with pytest.raises(InputError, match="difficulty: expected 0 to 1"):
        Difficulty(value)


def test_arguments_are_refused_before_anything_is_drawn() -> None:
    with pytest.raises(InputError, match="did you mean 'shelf'"):
        generate("shelv", 1)
    with pytest.raises(InputError, match="count 0"):
        generate("shelf", 0)
    with pytest.raises(InputError, match="seed -1"):
        generate("shelf", 1, -1)
