"""Settings that all tests share."""

from hypothesis import settings

# Examples are timed on machines that other work shares: a deadline would fail them for
# being slow. They are derived from the test alone, so that a run can be repeated.
settings.register_profile("mmplan", deadline=None, derandomize=True)
settings.load_profile("mmplan")
