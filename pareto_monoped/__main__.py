"""``python -m pareto_monoped``: the same as the console script."""

from pareto_monoped.cli import main

if __name__ == "__main__":
    main()
