"""Files that people write: YAML with places, checked into plain values.

Nothing in here imports Pinocchio, coal or OMPL, so that a faulty file is reported at
once.
"""
