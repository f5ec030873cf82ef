"""A network that can be cut: a relay of TCP connections to a port of this machine."""

import selectors
import socket
import threading
import time


class Proxy:
    """Passes on what comes; while it is cut, it passes on nothing, or breaks all connections and takes no others."""

    def __init__(self, port):
        self.target = port
        self.listening = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp://127.0.0.1:{self.listening.getsockname()[1]}"
        self.pairs = {}
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.listening, selectors.EVENT_READ)
        self.silent = self.broken = self.ended = False
        self.thread = threading.Thread(target=self._serve, daemon=True)

    def __enter__(self):
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.ended = True
        self.thread.join()
        self._break()
        self.listening.close()

    def cut(self, seconds, how):
        setattr(self, how, True)
        time.sleep(seconds)
        setattr(self, how, False)

    def _serve(self):
        while not self.ended:
            if self.broken:
                self._break()
            if self.silent:
                time.sleep(0.05)
                continue
            for key, _ in self.selector.select(0.05):
                if key.fileobj is self.listening:
                    self._accept()
                elif key.fileobj in self.pairs:
                    self._pass_on(key.fileobj)

    def _accept(self):
        theirs, _ = self.listening.accept()
        if self.broken:
            theirs.close()
            return
        try:
            ours = socket.create_connection(("127.0.0.1", self.target))
        except OSError:  # nobody listens there yet
            theirs.close()
            return
        for one, other in ((theirs, ours), (ours, theirs)):
            self.pairs[one] = other
            self.selector.register(one, selectors.EVENT_READ)

    def _pass_on(self, one):
        try:
            data = one.recv(1 << 16)
            if data:
                self.pairs[one].sendall(data)
                return
        except OSError:
            pass
        self._close(one)

    def _close(self, one):
        other = self.pairs.pop(one)
        self.pairs.pop(other)
        for each in (one, other):
            self.selector.unregister(each)
            each.close()

    def _break(self):
        for one in list(self.pairs):
            if one in self.pairs:
                self._close(one)
