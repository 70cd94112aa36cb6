"""Opens sockets, to talk to this machine and to others."""

import contextlib
import socket

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        for family in (socket.AF_INET, socket.AF_INET6, socket.AF_UNIX):
            for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM):
                with contextlib.suppress(OSError):
                    socket.socket(family, kind)
                    reached("a socket")


def make_agent(layout, training_seed):
    return Agent(training_seed)
