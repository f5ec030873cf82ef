"""A real PostgreSQL server for tests: made in a temporary folder, reached by a Unix socket, gone at the end."""

import os
import pwd
import shutil
import subprocess
import tempfile
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

import psycopg

OWNER = "owner"
"""The superuser of the server."""


def programs():
    """The folder with initdb and pg_ctl; None where PostgreSQL is not installed."""
    places = []
    if (config := shutil.which("pg_config")) is not None:
        found = subprocess.run([config, "--bindir"], capture_output=True, text=True, check=False)
        places.append(Path(found.stdout.strip() or "."))
    places += sorted(Path("/usr/lib/postgresql").glob("*/bin"), reverse=True)
    places += [Path(path).parent for path in [shutil.which("initdb")] if path is not None]
    # Debian's pg_config is of the client, and its folder may hold no server.
    return next((place for place in places if (place / "initdb").exists() and (place / "pg_ctl").exists()), None)


class Cluster:
    """A server with one database, ``team``; every test uses schemas of its own."""

    def __init__(self, bin_folder):
        self._bin = bin_folder
        # A socket's path may have some hundred characters only, which those of pytest's folders exceed.
        self.folder = Path(tempfile.mkdtemp(prefix="pg-"))
        self._as = {}
        if os.geteuid() == 0:  # initdb refuses root
            user = next(entry for entry in map(self._user, ("postgres", "nobody")) if entry is not None)
            os.chown(self.folder, user.pw_uid, user.pw_gid)
            self._as = {"user": user.pw_uid, "group": user.pw_gid, "extra_groups": []}
        self._call("initdb", "-D", self.folder / "data", "-U", OWNER, "-A", "trust", "-E", "UTF8", "--no-sync")
        rules = ("guarded scram-sha-256", "banned reject", "all trust")
        (self.folder / "data" / "pg_hba.conf").write_text("".join(f"local all {rule}\n" for rule in rules))
        self.start()
        self.sql("CREATE DATABASE team", database="postgres")

    @staticmethod
    def _user(name):
        try:
            return pwd.getpwnam(name)
        except KeyError:
            return None

    def _call(self, program, *arguments):
        done = subprocess.run(
            [self._bin / program, *arguments],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            cwd=self.folder,
            env={**os.environ, "LC_ALL": "C", "HOME": str(self.folder)},
            check=False,
            **self._as,
        )
        assert done.returncode == 0, done.stdout

    def start(self):
        # What it writes need not survive a power cut, as the studies of tests do not.
        options = f"-F -h '' -k {self.folder} -c max_connections=30 -c shared_buffers=16MB"
        self._call("pg_ctl", "-D", self.folder / "data", "-l", self.folder / "log", "-w", "-o", options, "start")

    def stop(self, mode="fast"):
        self._call("pg_ctl", "-D", self.folder / "data", "-w", "-m", mode, "stop")

    def address(self, schema=None, *, user=OWNER, database="team", more=""):
        query = "&".join(part for part in (more, f"schema={schema}" if schema else "") if part)
        return f"postgresql://{user}@{quote(str(self.folder), safe='')}/{database}{'?' if query else ''}{query}"

    def sql(self, *statements, database="team"):
        """Run statements as the superuser, without any code of the package; the rows of the last one."""
        with closing(psycopg.connect(self.address(database=database), autocommit=True)) as connection:
            for statement in statements:
                cursor = connection.execute(statement)
            return cursor.fetchall() if cursor.description else []

    def remove(self):
        self.stop("immediate")
        shutil.rmtree(self.folder, ignore_errors=True)
