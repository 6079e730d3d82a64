"""An inspected robot, in tables for people and as JSON for programs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from mmplan.terminal import grid

if TYPE_CHECKING:
    from rich.table import Table  # noqa: TID251  only its name

    from mmplan.robot_setup.inspection import Inspection, JointFacts, PairFacts
    from mmplan.robot_setup.link_bodies import LinkBodies


def report(inspection: Inspection, warnings: list[str]) -> Iterator[str | Table]:
    """Everything that was found, in the order in which people look at a robot."""
    robot = inspection.robot
    yield f"{robot.name}: {robot.description}"
    yield (
        f"base {robot.base_type}, radius {robot.base_radius:.3g} m, "
        f"reach {robot.reach:.3g} m"
    )
    yield ""
    headers = ("joint", "group", "lower", "upper", "per s", "per s²", "follows")
    yield grid(headers, map(_joint_row, inspection.joints), left=2)
    yield f"\n{_tool(inspection)}"
    for name, q_arm in robot.configurations.items():
        yield f"configuration {name}: [{', '.join(f'{x:g}' for x in q_arm)}]"
    yield ""
    columns = ("link", "moved by", "bodies", "stands off: mean", "most", "bare")
    rows = (_body_row(b, inspection.moved_by[b.link]) for b in inspection.bodies)
    yield grid(columns, rows, left=3)
    yield ""
    yield from _pairs(inspection)
    yield f"\n{_costs(inspection)}"
    for warning in warnings:
        yield f"warning: {warning}"


def _joint_row(joint: JointFacts) -> list[str]:
    numbers = (joint.lower, joint.upper, joint.velocity, joint.acceleration)
    texts = ["turns" if n is None else f"{n:.4g}" for n in numbers]
    return [joint.name, joint.group, *texts, joint.follows or ""]


def _body_row(body: LinkBodies, joint: str) -> list[str]:
    row = [body.link, joint or "-", body.kind]
    if body.standoff is None:
        return [*row, "", "", ""]
    return [*row, *(f"{1e3 * x:.1f} mm" for x in body.standoff)]


def _tool(inspection: Inspection) -> str:
    tool = inspection.tool
    T = tool.T_link_tool.round(4) + 0.0  # neither 1e-17 nor -0
    xyz = ", ".join(f"{x:.4g}" for x in T[:3, 3])
    axes = ", ".join(
        f"{name} = [{', '.join(f'{x:.2f}' for x in T[:3, k])}]"
        for k, name in ((2, "approach z"), (1, "closing y"))
    )
    return f"tool frame '{tool.frame}' in '{tool.link}': at [{xyz}] m, {axes}"


def _pairs(inspection: Inspection) -> Iterator[str | Table]:
    kept = [p for p in inspection.pairs if p.reason is None]
    off = [p for p in inspection.pairs if p.reason is not None]
    yield f"{len(kept)} pairs of links are checked against each other:"
    yield grid(("link", "link", "overlap"), map(_kept_row, kept), left=2)
    yield f"\n{len(off)} pairs are not checked:"
    yield grid(("link", "link", "reason", "seen"), map(_off_row, off), left=3)


def _kept_row(pair: PairFacts) -> list[str]:
    return [pair.first, pair.second, seen(pair)]


def _off_row(pair: PairFacts) -> list[str]:
    return [pair.first, pair.second, pair.reason or "", seen(pair)]


def seen(pair: PairFacts) -> str:
    """What samples say of a pair: how often it overlaps or how near it comes."""
    share, distance = pair.evidence.share, pair.evidence.distance
    if share == 0.0:
        return f"> {1e3 * distance:.3g} mm"
    return f"{100 * share:.3g} %" if share > 1.0 / pair.evidence.samples else "rarely"


def _costs(inspection: Inspection) -> str:
    ik, name = inspection.ik, inspection.robot.ik_solver
    solver = inspection.robot.ik
    proof = "" if solver.complete else "; cannot prove a pose out of reach"
    return (
        f"inverse kinematics '{name}': {100 * ik.solved:.1f} % of {ik.poses} reachable "
        f"poses solved, {ik.branches:.1f} solutions a pose, error {ik.error:.1e} m, "
        f"{1e6 * ik.seconds:.1f} µs a pose\n"
        f"  {solver.explanation}{proof}\n"
        f"collision with itself: {1e6 * inspection.collision:.1f} µs a configuration"
    )


def as_json(inspection: Inspection, warnings: list[str]) -> dict[str, Any]:
    """What `mmplan robot inspect --json` prints: metres, radians, seconds."""
    robot, tool = inspection.robot, inspection.tool
    return {
        "name": robot.name,
        "description": robot.description,
        "path": str(robot.path),
        "base": {"type": robot.base_type, "radius": robot.base_radius},
        "reach": robot.reach,
        "joints": [joint._asdict() for joint in inspection.joints],
        "tool": {
            "frame": tool.frame,
            "link": tool.link,
            "pose": tool.T_link_tool.tolist(),
        },
        "configurations": {k: q.tolist() for k, q in robot.configurations.items()},
        "bodies": [
            {
                "link": body.link,
                "moved_by": inspection.moved_by[body.link] or None,
                "kind": body.kind,
                "standoff": body.standoff and body.standoff._asdict(),
            }
            for body in inspection.bodies
        ],
        "pairs": [
            {
                "links": [pair.first, pair.second],
                "checked": pair.reason is None,
                "reason": pair.reason,
                **pair.evidence._asdict(),
            }
            for pair in inspection.pairs
        ],
        "ik": {
            "solver": robot.ik_solver,
            "how": robot.ik.explanation,
            "complete": robot.ik.complete,
            **inspection.ik._asdict(),
        },
        "collision_seconds": inspection.collision,
        "warnings": warnings,
    }
