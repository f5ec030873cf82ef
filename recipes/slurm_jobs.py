"""Run a command of pareto-monoped on workers that are jobs of SLURM of their own; needs dask-jobqueue here.

    python slurm_jobs.py --jobs 10 --cores 16 robust case_c.db

Run it where ``sbatch`` is, such as on a login node. The jobs start when the queue lets them, each with one worker per
core, and those that have started begin. If a job ends, the others do its tasks. All nodes have this package with the
extra ``cluster`` under the same Python. For other queues (PBS, SGE, LSF, HTCondor), dask-jobqueue has classes of the
same kind, and account, partition and the like are options of it or of its file ``jobqueue.yaml``.
"""

import argparse
import subprocess
import sys

from dask_jobqueue import SLURMCluster

parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
parser.add_argument("--jobs", type=int, default=2)
parser.add_argument("--cores", type=int, default=1, help="of each job")
parser.add_argument("--partition", help="of the queue; SLURM's default otherwise")
parser.add_argument("--time", default="04:00:00", help="of each job")
parser.add_argument("--interface", help="network between the nodes, such as ib0")
parser.add_argument("command", nargs=argparse.REMAINDER, help="of pareto-monoped, without --scheduler")

if __name__ == "__main__":
    asked = parser.parse_args()
    with SLURMCluster(
        cores=asked.cores,
        processes=asked.cores,
        memory=f"{asked.cores} GB",
        queue=asked.partition,
        walltime=asked.time,
        interface=asked.interface,
        scheduler_options={"dashboard": False, "dashboard_address": ":0"},
    ) as cluster:
        cluster.scale(jobs=asked.jobs)
        command = [sys.executable, "-m", "pareto_monoped", *asked.command, "--scheduler", cluster.scheduler_address]
        code = subprocess.run(command, check=False).returncode
    sys.exit(code)
