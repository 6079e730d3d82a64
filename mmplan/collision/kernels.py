"""Compiled loops of the broadphase: boxes against boxes.

Needs numba. All is in one file, since numba keeps what it compiled as long as the file
does not change, whatever becomes of others; and functions are long, since counting the
references to arrays that are handed on takes longer than what is done with them.

A body is known by the oriented box about it, (4, 4): above the box's pose,
in the last row its half extents and the radius of the ball about it. Boxes are apart if
one of the 15 axes of Gottschalk, Lin and Manocha ("OBBTree", SIGGRAPH 1996) separates
them.

Arguments that several functions share:

    numbers, integers: All that is known of the bodies, and room to work in; see
        `Tables`. As two arrays they are handed over four times as fast as one by one.
    clear: Tables of clear cells, (k, c, c); see `clear_cells`.
    found: What was found, see there, (c, 3); finds beyond c are counted only.
    depth: By how much the boxes of each find overlap, m, and how fast the pair can come
        nearer to each other from there to the ends of the stretch, m for the whole
        motion, (c, 2).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit, types

from mmplan.collision.pairs import CERTAIN, Flags, Indices
from mmplan.collision.planner_space import ROUNDING
from mmplan.shapes import Array

STATIC, MOVING = -2, -1

# Added to the cosines between axes, so that nearly parallel ones separate nothing that
# touches.
_ROUNDING = 1e-12
# Where bodies can come nearer by more than this, m, boxes are not compared with boxes.
_COARSE = 0.1
# Bodies that can come nearer by more than this, m, are not yet handed over.
_CLOSE = 0.05
# Into how many parts a motion can be cut, and how often it is halved at most.
PARTS = 1 << 30
HALVINGS = 16
# Where `check_edge` leaves the number of steps, and how many integers come first.
STEPS = 6
_HEAD = 7


class Sizes(NamedTuple):
    """How many there are of each."""

    joints: int
    nq: int
    moving: int
    static: int
    pairs: int
    balls: int  # in a moving body


class Tables(NamedTuple):
    """What is known of the bodies, then room that the functions here work in."""

    # Poses of joints in their parents' frames, (joints, 4, 3, 4), for each the factors
    # of 1, sin q, cos q and q.
    basis: Array
    # The axis of each joint in its frame, and 1 if it turns, (joints, 4).
    axes: Array
    # The boxes of the moving bodies in the frames of their joints, (m, 4, 4).
    moving: Array
    # The boxes of the bodies that stand still, in the world, (s, 4, 4).
    static: Array
    # The lower and the upper corner of the upright boxes about these, (s, 6).
    upright: Array
    # Centres and radii of balls within the moving bodies, in the frames of their boxes,
    # (m, b, 4).
    balls: Array
    # Boxes within the bodies that stand still, in the world, (s, 4, 4).
    cores: Array
    # How deep a ball must be in a core for a pair to collide for sure, (p,), m.
    surely: Array
    # How far each joint can carry a moving body, (m, nq), m/rad or m/m.
    own: Array
    # How far it can carry the bodies of a pair towards each other, (p, nq).
    levers: Array
    # Which joints each table of clear cells is about, and its cells, (p, 6).
    cells: Array
    # Parent and place in q of each joint, (2, joints).
    tree: Indices
    # The joint of each moving body, (m,).
    joint: Indices
    # For each pair its number, its moving body, the other body, and what the latter is:
    # `STATIC`, or moving too: `MOVING`, or the table of clear cells that holds for
    # both, (p, 4).
    pairs: Indices
    # The poses of all joints, (joints + 1, 3, 4), of which the first is the world's.
    T: Array
    # The joints' axes in the world, (joints, 3).
    turns: Array
    # The boxes of the moving bodies in the world, (m, 4, 4).
    boxes: Array
    # How far each joint can carry them from there, (m, nq).
    arms: Array
    # A motion's size, where one is in it, and how far that may be off, (nq,).
    span: Array
    here: Array
    spread: Array
    # How far a motion carries each moving body in all, and from where it is, (m,).
    far: Array
    pace: Array
    # Cosines between the axes of two boxes, (3, 3, 3).
    cosines: Array
    # When each moving body was placed last, (m,).
    placed: Indices
    # The pairs that are followed, (p * (HALVINGS + 2),).
    lists: Indices
    # Stretches to look at: first, last, and where their list is, (HALVINGS + 2, 4).
    todo: Indices


@njit(cache=True)
def needed(sizes: Sizes) -> tuple[int, int]:
    """How many numbers and how many integers tables of some sizes take."""
    joints, nq, m, s, p, balls = sizes
    numbers = joints * (48 + 4 + 12 + 3) + 12 + m * (16 + 4 * balls + 16 + 2)
    numbers += s * (16 + 6 + 16) + p * 7 + nq * (2 * m + p + 3) + 27
    integers = 2 * joints + 2 * m + p * (4 + HALVINGS + 2) + 4 * (HALVINGS + 2)
    return numbers, integers + _HEAD


@njit(cache=True)
def tables(numbers: Array, integers: Indices) -> Tables:
    """Views of the tables in two arrays; the integers begin with their sizes.

    After these comes how many steps `check_edge` cut the last edge into.
    """
    joints, nq, m = integers[0], integers[1], integers[2]
    s, p, b = integers[3], integers[4], integers[5]
    at, n = 0, joints * 48
    basis = numbers[at : at + n].reshape(joints, 4, 3, 4)
    at, n = at + n, joints * 4
    axes = numbers[at : at + n].reshape(joints, 4)
    at, n = at + n, m * 16
    moving = numbers[at : at + n].reshape(m, 4, 4)
    at, n = at + n, s * 16
    static = numbers[at : at + n].reshape(s, 4, 4)
    at, n = at + n, s * 6
    upright = numbers[at : at + n].reshape(s, 6)
    at, n = at + n, m * b * 4
    balls = numbers[at : at + n].reshape(m, b, 4)
    at, n = at + n, s * 16
    cores = numbers[at : at + n].reshape(s, 4, 4)
    at, n = at + n, p
    surely = numbers[at : at + n]
    at, n = at + n, m * nq
    own = numbers[at : at + n].reshape(m, nq)
    at, n = at + n, p * nq
    levers = numbers[at : at + n].reshape(p, nq)
    at, n = at + n, p * 6
    cells = numbers[at : at + n].reshape(p, 6)
    at, n = at + n, (joints + 1) * 12
    T = numbers[at : at + n].reshape(joints + 1, 3, 4)
    at, n = at + n, joints * 3
    turns = numbers[at : at + n].reshape(joints, 3)
    at, n = at + n, m * 16
    boxes = numbers[at : at + n].reshape(m, 4, 4)
    at, n = at + n, m * nq
    arms = numbers[at : at + n].reshape(m, nq)
    at, n = at + n, nq
    span = numbers[at : at + n]
    at = at + n
    here = numbers[at : at + n]
    at = at + n
    spread = numbers[at : at + n]
    at, n = at + n, m
    far = numbers[at : at + n]
    at = at + n
    pace = numbers[at : at + n]
    at, n = at + n, 27
    cosines = numbers[at : at + n].reshape(3, 3, 3)
    at, n = _HEAD, 2 * joints
    tree = integers[at : at + n].reshape(2, joints)
    at, n = at + n, m
    joint = integers[at : at + n]
    at, n = at + n, p * 4
    pairs = integers[at : at + n].reshape(p, 4)
    at, n = at + n, m
    placed = integers[at : at + n]
    at, n = at + n, p * (HALVINGS + 2)
    lists = integers[at : at + n]
    at, n = at + n, (HALVINGS + 2) * 4
    todo = integers[at : at + n].reshape(HALVINGS + 2, 4)
    return Tables(
        basis,
        axes,
        moving,
        static,
        upright,
        balls,
        cores,
        surely,
        own,
        levers,
        cells,
        tree,
        joint,
        pairs,
        T,
        turns,
        boxes,
        arms,
        span,
        here,
        spread,
        far,
        pace,
        cosines,
        placed,
        lists,
        todo,
    )


@njit(cache=True)
def find_suspects(
    q: Array,
    numbers: Array,
    integers: Indices,
    clear: Flags,
    found: Indices,
    depth: Array,
) -> int:
    """Write the pairs whose boxes overlap to `found` and return their number.

    Or `CERTAIN`, and what is written is void.

    Args:
        q: Configurations (n, nq).
        numbers: See above.
        integers: See above.
        clear: See above.
        found: Row and pair's number of each find, by row.
        depth: See above.
    """
    t = tables(numbers, integers)
    joint, pairs, placed, boxes, static = t.joint, t.pairs, t.placed, t.boxes, t.static
    count = 0
    for i in range(len(joint)):
        placed[i] = 0
    for row in range(len(q)):
        for k in range(q.shape[1]):
            t.here[k], t.spread[k] = q[row, k], 0.0
        _place_joints(t.here, t.tree, t.basis, t.axes, t.T, t.turns)
        for e in range(len(pairs)):
            i, j = pairs[e, 1], pairs[e, 2]
            if placed[i] <= row:
                placed[i] = row + 1
                _place_box(t.T, joint[i], t.moving, boxes, i)
            if pairs[e, 3] == STATIC:
                if _is_off(t.upright, j, boxes, i, 0.0):
                    continue
                overlap = _overlap(static, j, boxes, i, 0.0, t.cosines)
                if overlap >= 0.0 and _are_one(
                    boxes, i, t.balls, t.cores, j, t.surely[pairs[e, 0]]
                ):
                    _bring_forward(pairs, e)
                    return CERTAIN
            else:
                if placed[j] <= row:
                    placed[j] = row + 1
                    _place_box(t.T, joint[j], t.moving, boxes, j)
                if _are_far(boxes, i, j, 0.0):
                    continue
                overlap = _overlap(boxes, j, boxes, i, 0.0, t.cosines)
            if overlap < 0.0:
                continue
            if _are_clear(t.here, t.spread, pairs[e, 3], t.cells, clear):
                continue
            if count < len(depth):
                found[count, 0], found[count, 1] = row, pairs[e, 0]
                depth[count, 0] = overlap
            count += 1
    return count


@njit(cache=True)
def search_motion(
    q: Array,
    dq: Array,
    steps: int,
    smallest: float,
    numbers: Array,
    integers: Indices,
    clear: Flags,
    found: Indices,
    depth: Array,
) -> int:
    """Write the pairs that may touch on the way from q to q + dq; return their number.

    Or `CERTAIN`, and what is written is void.

    The motion is halved again and again. A pair is followed into both halves unless its
    boxes are farther apart than the joints can carry the bodies within the stretch at
    hand, given how far these are from the joints' axes in the middle of it. So most
    pairs are dropped early, and most stretches never looked at.

    With `steps` above 0 the question is about the configurations q + k / steps · dq,
    k = 1, ..., steps, and stretches are runs of k. With 0 it is about the whole motion,
    and a pair is found with a stretch once its boxes overlap in the middle of it, or
    the bodies can come nearer by no more than `smallest` (m) within it.

    Args:
        q: Where the motion begins, (nq,).
        dq: The way from there, (nq,).
        steps: See above.
        smallest: See above.
        numbers: See the module.
        integers: See the module.
        clear: See the module.
        found: Of each find the pair's number, then the step twice or the first and the
            last of `PARTS` parts of the motion.
        depth: See the module.
    """
    t = tables(numbers, integers)
    joint, pairs, placed, boxes, static = t.joint, t.pairs, t.placed, t.boxes, t.static
    here, spread, span, lists, todo = t.here, t.spread, t.span, t.lists, t.todo
    far, pace, arms, room = t.far, t.pace, t.arms, t.cosines
    count = 0
    sampled = steps > 0
    parts = steps if sampled else PARTS
    for k in range(len(q)):
        span[k] = abs(dq[k])
    for i in range(len(joint)):
        placed[i], far[i] = 0, 0.0
        for k in range(len(q)):
            far[i] += t.own[i, k] * span[k]
    for e in range(len(pairs)):
        lists[e] = e
    node, open_ = 0, 1
    todo[0, 0], todo[0, 1] = 1 if sampled else 0, parts
    todo[0, 2], todo[0, 3] = 0, len(pairs)
    while open_ > 0:
        open_ -= 1
        first, last = todo[open_, 0], todo[open_, 1]
        start, end = todo[open_, 2], todo[open_, 3]
        middle = (first + last + 1) // 2
        half = max(middle - first, last - middle) / parts
        for k in range(len(q)):
            here[k] = q[k] + middle / parts * dq[k]
            spread[k] = half * span[k]
        _place_joints(here, t.tree, t.basis, t.axes, t.T, t.turns)
        node += 1
        short = not sampled and last - first <= PARTS >> HALVINGS
        kept = end
        for place in range(start, end):
            e = lists[place]
            i, j = pairs[e, 1], pairs[e, 2]
            if placed[i] < node:
                placed[i] = node
                _place_box(t.T, joint[i], t.moving, boxes, i)
                _reckon_pace(i, half * far[i], joint[i], t)
            speed = pace[i]
            reach = half * speed
            # Boxes are compared if that can tell more than the ball about one of them.
            if pairs[e, 3] == STATIC:
                if _is_off(t.upright, j, boxes, i, reach):
                    continue
                fine = reach <= _COARSE
                overlap = -1.0
                if fine:
                    overlap = _overlap(static, j, boxes, i, reach, room) - reach
                    if overlap < -reach:
                        continue
                elif _is_beyond(static, j, boxes, i, reach):
                    continue
                hit = overlap >= 0.0
                if (hit and sampled and reach > 0.0) or not (
                    fine or _is_beyond(static, j, boxes, i, 0.0)
                ):
                    overlap = _overlap(static, j, boxes, i, 0.0, room)
                    hit = overlap >= 0.0
                if hit and _are_one(
                    boxes, i, t.balls, t.cores, j, t.surely[pairs[e, 0]]
                ):
                    _bring_forward(pairs, e)
                    return CERTAIN
            else:
                if placed[j] < node:
                    placed[j] = node
                    _place_box(t.T, joint[j], t.moving, boxes, j)
                    _reckon_pace(j, half * far[j], joint[j], t)
                if _are_far(boxes, i, j, reach + half * pace[j]):
                    continue
                speed = 0.0
                for k in range(len(q)):
                    lever = min(t.levers[pairs[e, 0], k], arms[i, k] + arms[j, k])
                    speed += lever * span[k]
                reach = half * speed
                if _are_far(boxes, i, j, reach):
                    continue
                fine = reach <= _COARSE
                overlap = -1.0
                if fine:
                    overlap = _overlap(boxes, j, boxes, i, reach, room) - reach
                    if overlap < -reach:
                        continue
                if _are_clear(here, spread, pairs[e, 3], t.cells, clear):
                    continue
                hit = overlap >= 0.0
                if (hit and sampled and reach > 0.0) or not (
                    fine or _are_far(boxes, i, j, 0.0)
                ):
                    overlap = _overlap(boxes, j, boxes, i, 0.0, room)
                    hit = overlap >= 0.0
            if not sampled:
                hit = short or reach <= smallest or (hit and reach <= _CLOSE)
            if hit:
                if count < len(depth):
                    found[count, 0] = pairs[e, 0]
                    found[count, 1] = middle if sampled else first
                    found[count, 2] = middle if sampled else last
                    depth[count, 0], depth[count, 1] = overlap, speed
                count += 1
                if not sampled:
                    continue
            lists[kept] = e
            kept += 1
        if kept == end:
            continue
        # The first half comes last, so that it is looked at next.
        if middle < last:
            todo[open_, 0] = middle + 1 if sampled else middle
            todo[open_, 1], todo[open_, 2], todo[open_, 3] = last, end, kept
            open_ += 1
        if middle > first:
            todo[open_, 1] = middle - 1 if sampled else middle
            todo[open_, 0], todo[open_, 2], todo[open_, 3] = first, end, kept
            open_ += 1
    return count


@njit(cache=True)
def check_state(
    point: Array,
    places: Indices,
    space: Array,
    followers: Array,
    q: Array,
    numbers: Array,
    integers: Indices,
    clear: Flags,
    found: Indices,
    depth: Array,
) -> int:
    """What `find_suspects` says of one point of a planner's space; see `check_edge`.

    Sets q (1, nq) to its configuration.
    """
    _configure(point, 0, places, space, followers, q[0])
    return find_suspects(q, numbers, integers, clear, found, depth)


@njit(cache=True)
def check_edge(
    ends: Array,
    places: Indices,
    space: Array,
    followers: Array,
    resolution: float,
    q: Array,
    dq: Array,
    numbers: Array,
    integers: Indices,
    clear: Flags,
    found: Indices,
    depth: Array,
) -> int:
    """What `search_motion` says of the steps of an edge in a planner's space.

    Sets q (nq,) to the configuration where it begins and dq (nq,) to the way on.

    Args:
        ends: The coordinates of both ends, (2 k,).
        places: Where in q coordinates belong, (k,).
        space: Values of joints that stand still, what coordinates are divided by, 1 for
            joints that wrap, then lever arms: see `Sweep`; (3 + rows, nq).
        followers: Place, leader's place, multiplier and offset of those, (f, 4).
        resolution: How far any point may move between two steps, m.
        q: See above.
        dq: See above.
        numbers: See the module.
        integers: See the module.
        clear: See the module.
        found: See `search_motion`.
        depth: See the module.
    """
    nq = space.shape[1]
    _configure(ends, 0, places, space, followers, q)
    _configure(ends, len(places), places, space, followers, dq)
    for k in range(nq):
        if space[2, k] > 0.0:
            dq[k] += 2.0 * np.pi * np.rint((q[k] - dq[k]) / (2.0 * np.pi))
        dq[k] -= q[k]
    farthest = 0.0
    for row in range(3, len(space)):
        way = 0.0
        for k in range(nq):
            way += space[row, k] * abs(dq[k])
        farthest = max(farthest, way)
    steps = max(1, int(np.ceil(farthest / resolution - ROUNDING)))
    integers[STEPS] = steps
    return search_motion(q, dq, steps, 0.0, numbers, integers, clear, found, depth)


@njit(cache=True)
def find_free_time(
    q: Array,
    dq: Array,
    i: int,
    normal: Array,
    gap: float,
    speed: float,
    numbers: Array,
    integers: Indices,
) -> tuple[float, float]:
    """How long before and after q a body stays on its side of a plane.

    Of all along a normal (3,) towards it, it is `gap` (m) beyond the plane at q. Its
    points' speeds along the normal are linear in where they are, so that those of the
    box about it bound them; and as no point moves faster than `speed` (m for the whole
    motion), none speeds up by more than twice that times how far the joints turn.

    Returns:
        Shares of the motion from q (nq,) to q + dq.
    """
    t = tables(numbers, integers)
    boxes, T, turns = t.boxes, t.T, t.turns
    _place_joints(q, t.tree, t.basis, t.axes, T, turns)
    _place_box(T, t.joint[i], t.moving, boxes, i)
    rate, turning, u, v, w = 0.0, 0.0, 0.0, 0.0, 0.0
    above = t.joint[i]
    while above > 0:
        k = above - 1
        way = dq[t.tree[1, k]]
        above = t.tree[0, k]
        if t.axes[k, 3] > 0.0:
            turning += abs(way)
            x = way * (normal[1] * turns[k, 2] - normal[2] * turns[k, 1])
            y = way * (normal[2] * turns[k, 0] - normal[0] * turns[k, 2])
            z = way * (normal[0] * turns[k, 1] - normal[1] * turns[k, 0])
            rate += x * (boxes[i, 0, 3] - T[k + 1, 0, 3])
            rate += y * (boxes[i, 1, 3] - T[k + 1, 1, 3])
            rate += z * (boxes[i, 2, 3] - T[k + 1, 2, 3])
            u, v, w = u + x, v + y, w + z
            continue
        for axis in range(3):
            along = T[above, axis, 0] * t.basis[k, 3, 0, 3]
            along += T[above, axis, 1] * t.basis[k, 3, 1, 3]
            along += T[above, axis, 2] * t.basis[k, 3, 2, 3]
            rate += way * normal[axis] * along
    spread = 0.0
    for axis in range(3):
        along = u * boxes[i, 0, axis] + v * boxes[i, 1, axis] + w * boxes[i, 2, axis]
        spread += boxes[i, 3, axis] * abs(along)
    bend = turning * speed
    before = _time_to_go(gap, max(0.0, spread + rate), bend)
    after = _time_to_go(gap, max(0.0, spread - rate), bend)
    return max(before, gap / speed), max(after, gap / speed)


@njit(cache=True)
def _time_to_go(gap: float, speed: float, bend: float) -> float:
    """When a gap (m) is gone at a speed and twice a bend of acceleration."""
    root = speed + np.sqrt(speed * speed + 4.0 * bend * gap)
    return 2.0 * gap / root if root > 0.0 else np.inf


@njit(cache=True)
def _configure(
    points: Array, at: int, places: Indices, space: Array, followers: Array, q: Array
) -> None:
    """Set q (nq,) to the configuration of the point that begins there in `points`."""
    for k in range(len(q)):
        q[k] = space[0, k]
    for k in range(len(places)):
        q[places[k]] = points[at + k] / space[1, places[k]]
    for row in range(len(followers)):
        leader = q[int(followers[row, 1])]
        q[int(followers[row, 0])] = followers[row, 2] * leader + followers[row, 3]


@njit(cache=True)
def _place_joints(
    q: Array, tree: Indices, basis: Array, axes: Array, T: Array, turns: Array
) -> None:
    """Set T (joints + 1, 3, 4) to the joints' poses, and `turns` to their axes."""
    for k in range(tree.shape[1]):
        above, value = tree[0, k], q[tree[1, k]]
        sine, cosine = 0.0, 0.0
        if axes[k, 3] > 0.0:
            sine, cosine = np.sin(value), np.cos(value)
        for j in range(4):
            x = basis[k, 0, 0, j] + basis[k, 1, 0, j] * sine
            y = basis[k, 0, 1, j] + basis[k, 1, 1, j] * sine
            z = basis[k, 0, 2, j] + basis[k, 1, 2, j] * sine
            x += basis[k, 2, 0, j] * cosine + basis[k, 3, 0, j] * value
            y += basis[k, 2, 1, j] * cosine + basis[k, 3, 1, j] * value
            z += basis[k, 2, 2, j] * cosine + basis[k, 3, 2, j] * value
            for i in range(3):
                T[k + 1, i, j] = (
                    T[above, i, 0] * x + T[above, i, 1] * y + T[above, i, 2] * z
                )
        for i in range(3):
            T[k + 1, i, 3] += T[above, i, 3]
            turns[k, i] = (
                T[k + 1, i, 0] * axes[k, 0]
                + T[k + 1, i, 1] * axes[k, 1]
                + T[k + 1, i, 2] * axes[k, 2]
            )


@njit(cache=True)
def _place_box(T: Array, joint: int, moving: Array, boxes: Array, i: int) -> None:
    """Set box i of boxes (m, 4, 4) to where the pose of its joint takes it."""
    for j in range(4):
        x, y, z = moving[i, 0, j], moving[i, 1, j], moving[i, 2, j]
        for k in range(3):
            boxes[i, k, j] = (
                T[joint, k, 0] * x + T[joint, k, 1] * y + T[joint, k, 2] * z
            )
        boxes[i, 3, j] = moving[i, 3, j]
    for k in range(3):
        boxes[i, k, 3] += T[joint, k, 3]


@njit(cache=True)
def _reckon_pace(i: int, moved: float, above: int, t: Tables) -> None:
    """Bound how far joints carry body i, which is placed, if no farther than `moved`.

    Sets row i of `arms`, m/rad or m/m, and its sum with `span`.
    """
    boxes, T, turns, arms, span, own = t.boxes, t.T, t.turns, t.arms, t.span, t.own
    total, around = 0.0, boxes[i, 3, 3] + moved
    while above > 0:
        k = above - 1
        place = t.tree[1, k]
        arm = own[i, place]
        if t.axes[k, 3] > 0.0 and span[place] > 0.0:
            x = boxes[i, 0, 3] - T[above, 0, 3]
            y = boxes[i, 1, 3] - T[above, 1, 3]
            z = boxes[i, 2, 3] - T[above, 2, 3]
            along = x * turns[k, 0] + y * turns[k, 1] + z * turns[k, 2]
            beside = max(0.0, x * x + y * y + z * z - along * along)
            arm = min(arm, np.sqrt(beside) + around)
        arms[i, place] = arm
        total += arm * span[place]
        above = t.tree[0, k]
    t.pace[i] = total


@njit(cache=True)
def _are_clear(q: Array, spread: Array, table: int, cells: Array, clear: Flags) -> bool:
    """Whether two joints are where a pair of bodies is known to be apart.

    At a configuration q (nq,), from which each joint may be off by `spread` (nq,).
    """
    if table < 0:
        return False
    place = cells[table]
    a, b = int(place[0]), int(place[1])
    first = int(np.floor((q[a] - spread[a] - place[2]) / place[3]))
    last = int(np.floor((q[a] + spread[a] - place[2]) / place[3]))
    low = int(np.floor((q[b] - spread[b] - place[4]) / place[5]))
    high = int(np.floor((q[b] + spread[b] - place[4]) / place[5]))
    if min(first, low) < 0 or max(last, high) >= clear.shape[1]:
        return False
    for i in range(first, last + 1):
        for j in range(low, high + 1):
            if not clear[table, i, j]:
                return False
    return True


# In the following, bodies are rows of arrays of boxes: views of these would take longer
# to make than all else.


@njit(cache=True)
def _is_off(upright: Array, a: int, B: Array, b: int, margin: float) -> bool:
    """The same for an upright box."""
    radius = B[b, 3, 3] + margin
    square = 0.0
    for axis in range(3):
        centre = B[b, axis, 3]
        beyond = max(upright[a, axis] - centre, centre - upright[a, 3 + axis])
        if beyond > 0.0:
            square += beyond * beyond
    return square > radius * radius


@njit(cache=True)
def _is_beyond(A: Array, a: int, B: Array, b: int, margin: float) -> bool:
    """Whether a box is farther than a margin from the ball about another."""
    radius = B[b, 3, 3] + margin
    x = B[b, 0, 3] - A[a, 0, 3]
    y = B[b, 1, 3] - A[a, 1, 3]
    z = B[b, 2, 3] - A[a, 2, 3]
    square = 0.0
    for axis in range(3):
        along = A[a, 0, axis] * x + A[a, 1, axis] * y + A[a, 2, axis] * z
        beyond = abs(along) - A[a, 3, axis]
        if beyond > radius:
            return True
        if beyond > 0.0:
            square += beyond * beyond
    return square > radius * radius


@njit(cache=True)
def _are_far(boxes: Array, i: int, j: int, margin: float) -> bool:
    """Whether the balls about two boxes are farther apart than a margin."""
    radius = boxes[i, 3, 3] + boxes[j, 3, 3] + margin
    x = boxes[i, 0, 3] - boxes[j, 0, 3]
    y = boxes[i, 1, 3] - boxes[j, 1, 3]
    z = boxes[i, 2, 3] - boxes[j, 2, 3]
    return x * x + y * y + z * z > radius * radius


@njit(cache=True)
def _bring_forward(pairs: Indices, e: int) -> None:
    """Let pair e come sooner from now on, since what collides tends to do so again."""
    for column in range(pairs.shape[1]):
        earlier = pairs[e // 2, column]
        pairs[e // 2, column] = pairs[e, column]
        pairs[e, column] = earlier


@njit(cache=True)
def _are_one(
    boxes: Array, i: int, balls: Array, cores: Array, j: int, surely: float
) -> bool:
    """Whether a ball within moving body i is so deep in the core of another."""
    for k in range(balls.shape[1]):
        room = balls[i, k, 3] - surely
        if room <= 0.0:
            continue
        # The way from the core's middle to the ball's, (x, y, z).
        u, v, w = balls[i, k, 0], balls[i, k, 1], balls[i, k, 2]
        x = boxes[i, 0, 3] - cores[j, 0, 3]
        x += boxes[i, 0, 0] * u + boxes[i, 0, 1] * v + boxes[i, 0, 2] * w
        y = boxes[i, 1, 3] - cores[j, 1, 3]
        y += boxes[i, 1, 0] * u + boxes[i, 1, 1] * v + boxes[i, 1, 2] * w
        z = boxes[i, 2, 3] - cores[j, 2, 3]
        z += boxes[i, 2, 0] * u + boxes[i, 2, 1] * v + boxes[i, 2, 2] * w
        square = 0.0
        for axis in range(3):
            along = (
                cores[j, 0, axis] * x + cores[j, 1, axis] * y + cores[j, 2, axis] * z
            )
            beyond = abs(along) - cores[j, 3, axis]
            if beyond > 0.0:
                square += beyond * beyond
        if square < room * room:
            return True
    return False


@njit(cache=True)
def _overlap(A: Array, a: int, B: Array, b: int, margin: float, room: Array) -> float:
    """The least overlap along the faces' normals; below 0 where an axis separates."""
    x = B[b, 0, 3] - A[a, 0, 3]
    y = B[b, 1, 3] - A[a, 1, 3]
    z = B[b, 2, 3] - A[a, 2, 3]
    least = np.inf
    for i in range(3):
        reach = A[a, 3, i] + margin
        for j in range(3):
            cosine = A[a, 0, i] * B[b, 0, j]
            cosine += A[a, 1, i] * B[b, 1, j]
            cosine += A[a, 2, i] * B[b, 2, j]
            room[0, i, j] = cosine
            room[1, i, j] = abs(cosine) + _ROUNDING
            reach += B[b, 3, j] * room[1, i, j]
        away = A[a, 0, i] * x + A[a, 1, i] * y + A[a, 2, i] * z
        room[2, 0, i] = away
        least = min(least, reach - abs(away))
        if least < 0.0:
            return least
    for j in range(3):
        reach = B[b, 3, j] + margin
        for i in range(3):
            reach += A[a, 3, i] * room[1, i, j]
        away = B[b, 0, j] * x + B[b, 1, j] * y + B[b, 2, j] * z
        least = min(least, reach - abs(away))
        if least < 0.0:
            return least
    for i in range(3):
        i1, i2 = (i + 1) % 3, (i + 2) % 3
        for j in range(3):
            j1, j2 = (j + 1) % 3, (j + 2) % 3
            reach = A[a, 3, i1] * room[1, i2, j] + A[a, 3, i2] * room[1, i1, j]
            reach += B[b, 3, j1] * room[1, i, j2] + B[b, 3, j2] * room[1, i, j1]
            away = abs(
                room[2, 0, i2] * room[0, i1, j] - room[2, 0, i1] * room[0, i2, j]
            )
            if away > reach:
                # The axis is as long as the sine of the angle between two edges.
                sine = np.sqrt(room[0, i1, j] ** 2 + room[0, i2, j] ** 2)
                if away > reach + margin * sine:
                    return -1.0
    return least


def _array(kind: types.Type, ndim: int, *, readonly: bool = False) -> types.Array:
    return types.Array(kind, ndim, "C", readonly=readonly)


def _compile() -> None:
    """Compile what others call for the types that they use, or load it.

    Otherwise that would be done, once for arrays that can be written to and once for
    others, in the middle of the first search that gets here.
    """
    known = (_array(types.float64, 1), _array(types.int64, 1), _array(types.bool_, 3))
    finds = (_array(types.int64, 2), _array(types.float64, 2))
    configurations = _array(types.float64, 2, readonly=True)
    configuration = _array(types.float64, 1, readonly=True)
    motion = (configuration, configuration, types.int64, types.float64)
    point = (_array(types.float64, 1), _array(types.int64, 1))
    space = (_array(types.float64, 2), _array(types.float64, 2))
    normal = _array(types.float64, 1, readonly=True)
    plane = (types.int64, normal, types.float64, types.float64)
    find_free_time.compile((configuration, configuration, *plane, *known[:2]))
    find_free_time.disable_compile()
    for function, own in (
        (find_suspects, (configurations,)),
        (search_motion, motion),
        (check_state, (*point, *space, _array(types.float64, 2))),
        (check_edge, (*point, *space, types.float64, *point[:1], *point[:1])),
    ):
        function.compile((*own, *known, *finds))
        function.disable_compile()


_compile()
