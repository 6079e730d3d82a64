"""Which of its two trees OMPL's RRTConnect extends."""

from __future__ import annotations


class Turns:
    """Leaves the work of one search by RRTConnect to the smaller of its trees.

    RRTConnect extends the tree of the start and that of the goals in turn. Where one of
    them is hemmed in, most of the work goes into the other one, which is large enough.
    So the larger one lets its turns pass: the motions that would extend it are refused
    unseen. That is the balanced search of S. LaValle, "Planning Algorithms" (2006),
    section 5.5.3.
    """

    def __init__(self) -> None:
        """Begin with one state in the start's tree and one in that of the goals."""
        self.sizes = [1, 1]
        self.taken = [0, 0]
        self.passes = False
        self._turn = self._extended = 1

    def begin(self) -> None:
        """Begin the next turn; the start's tree has the first."""
        self._turn = self._extended = 1 - self._turn
        self.passes = self.sizes[self._turn] > self.sizes[1 - self._turn]
        self.taken[self._turn] += not self.passes

    def note(self, *, free: bool) -> None:
        """Take note of a motion, which is added to a tree if it is free.

        The first of a turn extends the tree that has the turn, and all others extend
        the other tree towards it.
        """
        self.sizes[self._extended] += free
        self._extended = 1 - self._turn
