"""A study on a server that is open for writing."""

from pareto_monoped.storage.server.address import Server
from pareto_monoped.storage.server.connection import ServerConnection
from pareto_monoped.storage.server.lock import take


class ServerWriting:
    """A session that writes; see ``study.writing.Writing``."""

    def __init__(self, server: Server) -> None:
        self.connection = ServerConnection(server)
        try:
            take(self.connection, server, "write")
        except BaseException:
            self.connection.close()
            raise

    def examine(self) -> None:
        """Nothing: a server looks after its pages itself."""

    def settle(self) -> None:
        """Let a commit wait for the server's disk, where its owner has not asked for more than that."""
        self.connection.execute(
            "SELECT set_config('synchronous_commit', 'on', false) WHERE current_setting('synchronous_commit') = 'off'"
        )

    def require_place(self) -> None:
        """Nothing: what a server has committed is in the study's tables."""

    def close(self) -> None:
        """Close the session."""
        self.connection.close()

    def close_at_rest(self) -> None:
        """Close the session; a study at rest is like any other."""
        self.connection.close()
