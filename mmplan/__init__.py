"""Grasps, base placements and verified motions for mobile manipulators."""
