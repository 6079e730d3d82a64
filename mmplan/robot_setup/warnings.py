"""What to look at in a robot that was inspected."""

from __future__ import annotations

from collections.abc import Iterator

from mmplan.robot import Robot
from mmplan.robot_setup.adjacency import neighbours
from mmplan.robot_setup.fingers import closing_direction
from mmplan.robot_setup.inspection import Inspection, PairFacts
from mmplan.robot_setup.pieces import TIGHT

# Links that are not checked and come nearer than this: thin evidence, m.
THIN = 0.01
# Links that overlap this often are not meant to be apart.
_OFTEN = 0.5
_SOLVED = 0.99  # share of poses that inverse kinematics should solve
_TURNED = 0.9  # cosine of the largest angle between y and where the fingers close


def warnings(inspection: Inspection) -> Iterator[str]:
    """Everything that may be wrong, worst first."""
    robot = inspection.robot
    for name, pairs in inspection.named_collisions.items():
        yield f"configuration '{name}' is in collision: {', '.join(pairs)}"
    beside = neighbours(robot)
    for pair in inspection.pairs:
        if text := _about(pair, frozenset(pair[:2]) in beside):
            yield f"{pair.first} / {pair.second}: {text}"
    if inspection.ik.solved < _SOLVED:
        percent = 100 * inspection.ik.solved
        yield f"inverse kinematics solves only {percent:.1f} % of reachable poses"
    yield from _about_tool(robot)
    for body in inspection.bodies:
        if body.standoff is not None and body.standoff.largest > TIGHT:
            largest = f"{1e3 * body.standoff.largest:.0f} mm"
            yield f"{body.link}: its bodies stand off the mesh by up to {largest}"


def _about(pair: PairFacts, adjacent: bool) -> str | None:
    """What is odd about a pair of links."""
    share, distance = pair.evidence.share, pair.evidence.distance
    if pair.reason is None:
        return "checked, and in collision in every sample" if share == 1.0 else None
    reason = f"not checked ('{pair.reason}')"
    if adjacent or pair.reason.startswith("fingers"):
        return None
    if 0.0 < share < _OFTEN:
        how = f"in {100 * share:.2g} % of samples" if share > 1e-3 else "where searched"
        return f"{reason}, but the bodies overlap {how}"
    if share == 0.0 and distance < THIN:
        near = f"{distance * 1e3:.2g} mm"
        return f"{reason}, on thin evidence: they come as near as {near}"
    return None


def _about_tool(robot: Robot) -> Iterator[str]:
    """Whether the fingers close along y of the tool frame, and z points out."""
    closing = closing_direction(robot)
    if closing is not None and abs(closing[1]) < _TURNED:
        x, y, z = closing
        yield (
            f"tool frame: the fingers close along [{x:.2f}, {y:.2f}, {z:.2f}] in it, "
            "not along y"
        )
