"""Compiled loops of the broadphase: boxes against boxes.

Needs numba. All is in one file, since numba keeps what it compiled as long as the file
does not change, whatever becomes of others; and functions are long, since counting the
references to arrays that are handed on takes longer than what is done with them.

A body is known by the oriented box about it, (4, 4): above the box's pose,
in the last row its half extents and the radius of the ball about it. Boxes are apart if
one of the 15 axes of Gottschalk, Lin and Manocha ("OBBTree", SIGGRAPH 1996) separates
them.

Arguments that several functions share:

    tree: Parent and place in q of each joint, (2, joints).
    basis: Poses of joints in their parents' frames, (joints, 4, 3, 4), for each the
        factors of 1, sin q, cos q and q.
    joint: The joint of each moving body, (m,).
    moving: The boxes of these in the frames of their joints, (m, 4, 4).
    static: The boxes of the bodies that stand still, in the world, (s, 4, 4).
    pairs: For each pair its number, its moving body, the other body, and what the
        latter is: `STATIC`, or moving too: `MOVING`, or the table of clear cells that
        holds for both, (p, 4).
    cells, clear: Tables of clear cells, (k, 6) and (k, c, c); see `clear_cells`.
    balls: Centres and radii of balls within the moving bodies, in the frames of their
        boxes, (m, b, 4).
    cores: Boxes within the bodies that stand still, in the world, (s, 4, 4).
    surely: How deep a ball must be in a core for a pair to collide for sure, (p,), m.
    depth: By how much the boxes of each find overlap, m, and how fast the pair can come
        nearer to each other from there to the ends of the stretch, m for the whole
        motion, (c, 2).
"""

from __future__ import annotations

import numpy as np
from numba import njit, types

from mmplan.collision.pairs import CERTAIN, Flags, Indices
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


@njit(cache=True)
def find_suspects(
    q: Array,
    tree: Indices,
    basis: Array,
    joint: Indices,
    moving: Array,
    static: Array,
    pairs: Indices,
    cells: Array,
    clear: Flags,
    balls: Array,
    cores: Array,
    surely: Array,
    found: Indices,
    depth: Array,
) -> int:
    """Write the pairs whose boxes overlap to `found` and return their number.

    Or `CERTAIN`, and what is written is void.

    Args:
        q: Configurations (n, nq).
        found: Row and pair's number of each find, by row, (c, 2); those beyond c are
            counted only.
    """
    count = 0
    boxes, room = np.empty((len(joint), 4, 4)), np.empty((3, 3, 3))
    still, placed = np.zeros(q.shape[1]), np.zeros(len(joint), np.int64)
    T = np.zeros((tree.shape[1] + 1, 3, 4))
    T[0, 0, 0] = T[0, 1, 1] = T[0, 2, 2] = 1.0
    for row in range(len(q)):
        _place_joints(q[row], tree, basis, T)
        for e in range(len(pairs)):
            i, j = pairs[e, 1], pairs[e, 2]
            if placed[i] <= row:
                placed[i] = row + 1
                _place_box(T, joint[i], moving, boxes, i)
            if pairs[e, 3] == STATIC:
                if _is_beyond(static, j, boxes, i, 0.0):
                    continue
                overlap = _overlap(static, j, boxes, i, 0.0, room)
                if overlap >= 0.0 and _are_one(
                    boxes, i, balls, cores, j, surely[pairs[e, 0]]
                ):
                    _bring_forward(pairs, e)
                    return CERTAIN
            else:
                if placed[j] <= row:
                    placed[j] = row + 1
                    _place_box(T, joint[j], moving, boxes, j)
                if _are_far(boxes, i, j, 0.0):
                    continue
                overlap = _overlap(boxes, j, boxes, i, 0.0, room)
            if overlap < 0.0:
                continue
            if len(still) and _are_clear(q[row], still, pairs[e, 3], cells, clear):
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
    tree: Indices,
    basis: Array,
    axes: Array,
    own: Array,
    levers: Array,
    lists: Indices,
    joint: Indices,
    moving: Array,
    static: Array,
    pairs: Indices,
    cells: Array,
    clear: Flags,
    balls: Array,
    cores: Array,
    surely: Array,
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
        axes: The axis of each joint in its frame, and 1 if it turns, (joints, 4).
        own: How far each joint can carry a moving body, (m, nq), m/rad or m/m.
        levers: How far it can carry the bodies of a pair towards each other, (p, nq).
        lists: Room for the pairs that are followed, (p * (HALVINGS + 2),).
        found: Of each find the pair's number, then the step twice or the first and the
            last of `PARTS` parts of the motion, (c, 3); those beyond c are counted
            only.
        depth: By how much the boxes overlap, (c,), m.
    """
    count = 0
    sampled = steps > 0
    parts = steps if sampled else PARTS
    span, here, spread = np.abs(dq), np.empty(len(q)), np.empty(len(q))
    far, pace = np.zeros(len(joint)), np.empty(len(joint))
    arms = np.zeros((len(joint), len(q)))
    for i in range(len(joint)):
        for k in range(len(q)):
            far[i] += own[i, k] * span[k]
    for e in range(len(pairs)):
        lists[e] = e
    T = np.zeros((tree.shape[1] + 1, 3, 4))
    T[0, 0, 0] = T[0, 1, 1] = T[0, 2, 2] = 1.0
    boxes, room = np.empty((len(joint), 4, 4)), np.empty((3, 3, 3))
    placed, node = np.zeros(len(joint), np.int64), 0
    # Stretches yet to be looked at: first and last, and where their list of pairs is.
    todo = np.empty((HALVINGS + 2, 4), np.int64)
    todo[0] = (1 if sampled else 0, parts, 0, len(pairs))
    open_ = 1
    while open_ > 0:
        open_ -= 1
        first, last = todo[open_, 0], todo[open_, 1]
        start, end = todo[open_, 2], todo[open_, 3]
        middle = (first + last + 1) // 2
        half = max(middle - first, last - middle) / parts
        for k in range(len(q)):
            here[k] = q[k] + middle / parts * dq[k]
            spread[k] = half * span[k]
        _place_joints(here, tree, basis, T)
        node += 1
        short = not sampled and last - first <= PARTS >> HALVINGS
        kept = end
        for place in range(start, end):
            e = lists[place]
            i, j = pairs[e, 1], pairs[e, 2]
            if placed[i] < node:
                placed[i], moved = node, half * far[i]
                pace[i] = _place_mover(
                    T, joint, moving, boxes, i, moved, tree, axes, own, span, arms
                )
            speed = pace[i]
            if pairs[e, 3] != STATIC:
                if placed[j] < node:
                    placed[j], moved = node, half * far[j]
                    pace[j] = _place_mover(
                        T, joint, moving, boxes, j, moved, tree, axes, own, span, arms
                    )
                speed = 0.0
                for k in range(len(q)):
                    lever = min(levers[pairs[e, 0], k], arms[i, k] + arms[j, k])
                    speed += lever * span[k]
            reach = half * speed
            # Boxes are compared if that can tell more than the ball about one of them.
            fine = reach <= _COARSE
            if pairs[e, 3] == STATIC:
                if _is_beyond(static, j, boxes, i, reach):
                    continue
                overlap = -1.0
                if fine:
                    overlap = _overlap(static, j, boxes, i, reach, room) - reach
                    if overlap < -reach:
                        continue
                hit = overlap >= 0.0
                if (hit and sampled and reach > 0.0) or not (
                    fine or _is_beyond(static, j, boxes, i, 0.0)
                ):
                    overlap = _overlap(static, j, boxes, i, 0.0, room)
                    hit = overlap >= 0.0
                if hit and _are_one(boxes, i, balls, cores, j, surely[pairs[e, 0]]):
                    _bring_forward(pairs, e)
                    return CERTAIN
            else:
                if _are_far(boxes, i, j, reach):
                    continue
                overlap = -1.0
                if fine:
                    overlap = _overlap(boxes, j, boxes, i, reach, room) - reach
                    if overlap < -reach:
                        continue
                if pairs[e, 3] >= 0 and _are_clear(
                    here, spread, pairs[e, 3], cells, clear
                ):
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
            todo[open_] = (middle + 1 if sampled else middle, last, end, kept)
            open_ += 1
        if middle > first:
            todo[open_] = (first, middle - 1 if sampled else middle, end, kept)
            open_ += 1
    return count


@njit(cache=True)
def _place_joints(q: Array, tree: Indices, basis: Array, T: Array) -> None:
    """Set T (joints + 1, 3, 4) to the poses of all joints; T[0] is the world's."""
    relative = np.empty((1, 3, 4))
    for k in range(tree.shape[1]):
        value = q[tree[1, k]]
        sine, cosine = np.sin(value), np.cos(value)
        for i in range(3):
            for j in range(4):
                relative[0, i, j] = (
                    basis[k, 0, i, j]
                    + basis[k, 1, i, j] * sine
                    + basis[k, 2, i, j] * cosine
                    + basis[k, 3, i, j] * value
                )
        _compose(T, tree[0, k], relative, 0, T, k + 1)


@njit(cache=True)
def _place_box(T: Array, joint: int, moving: Array, boxes: Array, i: int) -> None:
    """Set box i of boxes (m, 4, 4) to where the pose of its joint takes it."""
    _compose(T, joint, moving, i, boxes, i)
    for k in range(4):
        boxes[i, 3, k] = moving[i, 3, k]


@njit(cache=True)
def _place_mover(
    T: Array,
    joint: Indices,
    moving: Array,
    boxes: Array,
    i: int,
    moved: float,
    tree: Indices,
    axes: Array,
    own: Array,
    span: Array,
    arms: Array,
) -> float:
    """Place box i and bound how far joints carry it, if no farther than `moved`.

    Sets row i of `arms` (m, nq), m/rad or m/m, and returns the sum with `span` (nq,).
    """
    _place_box(T, joint[i], moving, boxes, i)
    above = joint[i]
    total = 0.0
    while above > 0:
        k = above - 1
        place = tree[1, k]
        arm = own[i, place]
        if axes[k, 3] > 0.0:
            x = boxes[i, 0, 3] - T[above, 0, 3]
            y = boxes[i, 1, 3] - T[above, 1, 3]
            z = boxes[i, 2, 3] - T[above, 2, 3]
            along = 0.0
            for axis in range(3):
                u = T[above, 0, axis] * x + T[above, 1, axis] * y
                along += axes[k, axis] * (u + T[above, 2, axis] * z)
            beside = max(0.0, x * x + y * y + z * z - along * along)
            arm = min(arm, np.sqrt(beside) + boxes[i, 3, 3] + moved)
        arms[i, place] = arm
        total += arm * span[place]
        above = tree[0, k]
    return total


@njit(cache=True)
def _compose(A: Array, a: int, B: Array, b: int, out: Array, o: int) -> None:
    """Set pose o in `out` to the product of poses a in A and b in B."""
    for i in range(3):
        x, y, z = A[a, i, 0], A[a, i, 1], A[a, i, 2]
        for j in range(4):
            out[o, i, j] = x * B[b, 0, j] + y * B[b, 1, j] + z * B[b, 2, j]
        out[o, i, 3] += A[a, i, 3]


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
    table, vector, poses = (_array(types.float64, ndim) for ndim in (2, 1, 3))
    indices, index_table = (_array(types.int64, ndim) for ndim in (1, 2))
    tree = (index_table, _array(types.float64, 4))
    bodies = (indices, poses, poses, index_table, table, _array(types.bool_, 3))
    room = (poses, poses, vector, index_table, table)
    configurations = _array(types.float64, 2, readonly=True)
    configuration = _array(types.float64, 1, readonly=True)
    motion = (configuration, configuration, types.int64, types.float64)
    levers = (table, table, table, indices)
    find_suspects.compile((configurations, *tree, *bodies, *room))
    find_suspects.disable_compile()
    search_motion.compile((*motion, *tree, *levers, *bodies, *room))
    search_motion.disable_compile()


_compile()
