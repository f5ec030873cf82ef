"""``python -m pareto_monoped`` and the console script: an interrupt while modules are imported ends in one line."""

import gc
import os
import signal
from types import FrameType


def _interrupted(number: int, frame: FrameType | None) -> None:
    os.write(2, b"interrupted\n")
    os._exit(130)


def main() -> None:
    """Run the command line; ``cli.process`` takes over the signals."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupted)
    # Python looks for unreachable objects after 700 new ones; modules make a million, and none is unreachable.
    gc.set_threshold(50_000)
    # To look for plugins of pydantic, of which none is wanted, would take a tenth of a short command.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from pareto_monoped.cli import main as run_command

    run_command()


if __name__ == "__main__":
    main()
