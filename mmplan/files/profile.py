"""What is wrong with the outline of a solid of revolution."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

Point = tuple[float, float]

SMALLEST_AREA = 1e-9  # m^2
MOST_POINTS = 500


def profile_fault(profile: Sequence[Point]) -> str | None:
    """Why the outline (r, z), closed from last point to first, bounds no solid."""
    if len(profile) < 3:
        return f"an outline needs at least 3 points, got {len(profile)}"
    if len(profile) > MOST_POINTS:
        return f"an outline has at most {MOST_POINTS} points, got {len(profile)}"
    for i, (a, b) in enumerate(_edges(profile)):
        if a == b:
            return f"point {i + 1} is repeated right after itself"
    a, b = profile[0], profile[1]
    if all(abs(_turn(a, b, c)) < SMALLEST_AREA for c in profile):
        return "the outline encloses no area: its points lie on a line"
    if crossing := _crossing(profile):
        i, j = crossing
        return f"the outline crosses itself: edges {i + 1} and {j + 1}"
    if abs(_area(profile)) < SMALLEST_AREA:
        return "the outline encloses no area"
    return None


def _edges(profile: Sequence[Point]) -> Iterator[tuple[Point, Point]]:
    return zip(profile, [*profile[1:], profile[0]], strict=True)


def _area(profile: Sequence[Point]) -> float:
    """The signed area inside, by the shoelace formula."""
    return 0.5 * sum(a[0] * b[1] - b[0] * a[1] for a, b in _edges(profile))


def _crossing(profile: Sequence[Point]) -> tuple[int, int] | None:
    """The first two edges that share a point which is not a common end."""
    edges = list(_edges(profile))
    for i, first in enumerate(edges):
        for j in range(i + 1, len(edges)):
            neighbours = j == i + 1 or (i == 0 and j == len(edges) - 1)
            if (_folded if neighbours else _touch)(first, edges[j]):
                return i, j
    return None


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive where a, b, c turn left, negative to the right, 0 on a line."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _touch(first: tuple[Point, Point], second: tuple[Point, Point]) -> bool:
    """Whether two edges have a point in common."""
    a, b = first
    c, d = second
    turns = _turn(a, b, c), _turn(a, b, d), _turn(c, d, a), _turn(c, d, b)
    if turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0:
        return True
    ends = [(a, b, c), (a, b, d), (c, d, a), (c, d, b)]
    return any(
        turn == 0 and _between(*end) for turn, end in zip(turns, ends, strict=True)
    )


def _between(a: Point, b: Point, c: Point) -> bool:
    """Whether c, on the line through a and b, lies between them."""
    return all(min(a[k], b[k]) <= c[k] <= max(a[k], b[k]) for k in (0, 1))


def _folded(first: tuple[Point, Point], second: tuple[Point, Point]) -> bool:
    """Whether two edges with a common end run back over one another."""
    shared = first[1] if first[1] in second else first[0]
    a = first[0] if shared == first[1] else first[1]
    c = second[0] if shared == second[1] else second[1]
    along = (a[0] - shared[0]) * (c[0] - shared[0]) + (a[1] - shared[1]) * (
        c[1] - shared[1]
    )
    return _turn(shared, a, c) == 0 and along > 0
