"""Writes into the shared memory all the time, and tries to shrink it."""

import contextlib
import gc
import os
import threading

from common import Stays, reached

from overcooked_bench.agents.isolation.frames import Frame


class Agent(Stays):
    def attack(self):
        (frame,) = (thing for thing in gc.get_objects() if type(thing) is Frame)
        for name in os.listdir("/proc/self/map_files") if os.access("/proc/self/map_files", os.R_OK) else ():
            with contextlib.suppress(OSError):
                if "memfd" in os.readlink(f"/proc/self/map_files/{name}"):
                    os.truncate(f"/proc/self/map_files/{name}", 0)
                    reached("the size of the frame")
        threading.Thread(target=_scribble, args=(frame,), daemon=True).start()


def _scribble(frame):
    while True:
        frame.memory[:16] = os.urandom(16)


def make_agent(layout, training_seed):
    return Agent(training_seed)
