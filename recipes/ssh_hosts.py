"""Run a command of pareto-monoped on several hosts that SSH reaches; needs asyncssh here, Dask everywhere.

    python ssh_hosts.py --workers 8 host1,host2,host3 robust case_c.db

The first host also runs the scheduler. Every host has this package with the extra ``cluster``, and is known to SSH: its
key stands in ``known_hosts``, and yours logs in without a password. At the end everything on the hosts is ended. What
is left on them if this program is killed ends by itself after an hour without work.

NumPy's linear algebra has code of its own for each kind of processor, which rounds differently. If the hosts are of
several kinds, set ``OPENBLAS_CORETYPE=Haswell`` here: the workers get the same setting.
"""

import argparse
import os
import subprocess
import sys

import dask
from distributed import SSHCluster

parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
parser.add_argument("--workers", type=int, default=1, help="processes per host: one per core")
parser.add_argument("--python", default=sys.executable, help="Python on the hosts; the same path as here by default")
parser.add_argument("hosts", help="names or addresses, by commas")
parser.add_argument("command", nargs=argparse.REMAINDER, help="of pareto-monoped, without --scheduler")

if __name__ == "__main__":
    asked = parser.parse_args()
    hosts = asked.hosts.split(",")
    if kind := os.environ.get("OPENBLAS_CORETYPE"):
        dask.config.set({"distributed.nanny.pre-spawn-environ.OPENBLAS_CORETYPE": kind})
    with SSHCluster(
        [hosts[0], *hosts],
        remote_python=asked.python,
        scheduler_options={"host": hosts[0], "dashboard": False, "dashboard_address": ":0", "idle_timeout": "1 hour"},
        worker_options={"n_workers": asked.workers, "nthreads": 1},
    ) as cluster:
        command = [sys.executable, "-m", "pareto_monoped", *asked.command, "--scheduler", cluster.scheduler_address]
        code = subprocess.run(command, check=False).returncode
    sys.exit(code)
