"""A process that has the readers loaded and forks a child for each call. It never looks at what is read itself.

`python -m store.isolation.template FD MODULE…`: FD is a stream socket. Each message on it is a struct MESSAGE with the
descriptors (life, request, answer[, attached]). The end of the child is told on `life`, a socket whose closing kills it.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import signal
import socket
import sys
from importlib import import_module

from .child import MESSAGE, Limits, fork


class Template:
    def __init__(self, control: socket.socket):
        self._control = control
        self._selector = selectors.DefaultSelector()
        self._lives: dict[int, socket.socket] = {}

    def run(self) -> None:
        """Until the other end of the control socket is closed."""
        wake_read, wake_write = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC) if hasattr(os, "pipe2") else _pipe()
        signal.set_wakeup_fd(wake_write, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.signal(signal.SIGINT, signal.SIG_IGN)  # of a terminal: the owner ends, and with it the socket
        self._selector.register(self._control, selectors.EVENT_READ)
        self._selector.register(wake_read, selectors.EVENT_READ)
        while True:
            for key, _ in self._selector.select():
                if key.fileobj is self._control:
                    if not self._start():
                        return self._kill_all()
                elif key.fileobj == wake_read:
                    with contextlib.suppress(BlockingIOError):
                        os.read(wake_read, 4096)
                elif key.data in self._lives:
                    os.kill(key.data, signal.SIGKILL)
                    self._selector.unregister(key.fileobj)
            self._reap()

    def _start(self) -> bool:
        try:
            message, descriptors, _, _ = socket.recv_fds(self._control, MESSAGE.size, 4)
        except OSError:
            return False
        if len(message) != MESSAGE.size or len(descriptors) < 3:
            return False
        life, request, answer, attached = [*descriptors, -1][:4]
        cpu, wall, memory, size = MESSAGE.unpack(message)
        pid = fork(request, answer, attached, Limits(cpu, wall, memory, size))
        for number in descriptors[1:]:
            os.close(number)
        self._lives[pid] = socket.socket(fileno=life)
        self._selector.register(self._lives[pid], selectors.EVENT_READ, pid)
        return True

    def _reap(self) -> None:
        while self._lives:
            pid, status = os.waitpid(-1, os.WNOHANG)
            if not pid:
                return
            life = self._lives.pop(pid)
            with contextlib.suppress(KeyError):
                self._selector.unregister(life)
            with contextlib.suppress(OSError):
                life.sendall(str(os.waitstatus_to_exitcode(status)).encode())
            life.close()

    def _kill_all(self) -> None:
        for pid in self._lives:
            os.kill(pid, signal.SIGKILL)


def _pipe() -> tuple[int, int]:
    read, write = os.pipe()
    os.set_blocking(read, False)
    os.set_blocking(write, False)
    return read, write


if __name__ == "__main__":
    own = socket.socket(fileno=int(sys.argv[1]))
    for module in sys.argv[2:]:
        import_module(module)
    Template(own).run()
