"""Settings that all tests share."""

import ctypes.util
import os
import signal

from hypothesis import settings

# Examples are timed on machines that other work shares: a deadline would fail them for
# being slow. They are derived from the test alone, so that a run can be repeated.
settings.register_profile("mmplan", deadline=None, derandomize=True)
settings.load_profile("mmplan")

# MuJoCo decides how to draw when it is first imported, which may be by a test that
# draws nothing: without a window, for those that do.
if ctypes.util.find_library("EGL"):
    os.environ.setdefault("MUJOCO_GL", "egl")

# What a shell runs in the background is deaf to interrupts, and would hand that on to
# the commands that tests start and interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)
