"""A staff in this process, whose workers do what a test tells them: for what real programs do only now and then."""

from concurrent.futures import Executor, Future

from pareto_monoped.compute.crew import LostError, Member


class Worker(Executor):
    """Does a task at once, in the thread that gives it; a task in ``later`` when it is told, one in ``lost`` never.

    Attributes:
        given: functions of its tasks, the greeting first.
    """

    def __init__(self, *, later=(), lost=(), slots=None):
        self.later, self.lost, self.slots = later, lost, slots
        self.given, self.kept = [], []

    def submit(self, function, *arguments):
        self.given.append(function)
        answer = Future()
        if function in self.lost:
            answer.set_exception(LostError("gone"))
        elif function in self.later:
            self.kept.append((answer, function, arguments))
        else:
            self._answer(answer, function, arguments)
        return answer

    def tell(self, most=99):
        """Answer what was kept, the oldest first."""
        for _ in range(min(most, len(self.kept))):
            self._answer(*self.kept.pop(0))

    def lose(self):
        """End with all that was kept."""
        kept, self.kept = self.kept, []
        for answer, _, _ in kept:
            answer.set_exception(LostError("gone"))

    @staticmethod
    def _answer(answer, function, arguments):
        try:
            answer.set_result(function(*arguments))
        except Exception as problem:
            answer.set_exception(problem)


class StaffHere:
    """Workers by name; ``replaces`` as that of ``LocalProcesses``."""

    label, cure = "staff here", "call others"

    def __init__(self, workers, *, replaces=False, slots=1, dismiss=lambda name: None):
        self.workers, self.replaces, self.dismiss = workers, replaces, dismiss
        self.slots, self.closed = slots, False

    def present(self):
        return {
            name: Member(name=name, executor=worker, threads=3, slots=worker.slots or self.slots)
            for name, worker in dict(self.workers).items()
        }

    def state(self):
        return "nobody came"

    def is_loss(self, problem):
        return False

    def close(self):
        self.closed = True
