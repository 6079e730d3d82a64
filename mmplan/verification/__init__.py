"""The independent proof of a plan."""

from mmplan.verification.verify import examine, verify

__all__ = ["examine", "verify"]
