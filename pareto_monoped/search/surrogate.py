"""Search by many offspring, ranked by a cheap model, of which the most promising are simulated.

Local searches on the model alone show where designs lead once every variable is chosen anew. A search over motors also
looks at the ends of each motor's own front, so that none is given up too early.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from pareto_monoped.definition.algorithms import SurrogateSettings
from pareto_monoped.search.algorithm import Algorithm, Floats, Proposal, Scores, Space
from pareto_monoped.search.archive import TOLERATED, Archive, Standing
from pareto_monoped.search.prediction import CURIOSITY, PENALTY, Prediction, gains, ranked, unlike
from pareto_monoped.search.response_surface import Features, features_of
from pareto_monoped.search.seen import Seen, drawn
from pareto_monoped.search.variation import offspring, scans, small_steps, spread


def one_thread() -> Any:
    """Return a context in which linear algebra uses one thread.

    Sums of several threads depend on their number, so a search would take another course on other machines. Matrices of
    a few hundred rows are also faster: OpenBLAS's threads wait for each other in busy loops.
    """
    return _controller().limit(limits=1, user_api="blas")


@lru_cache(maxsize=1)
def _controller() -> Any:
    import numpy  # noqa: F401  both libraries must be loaded before their threads can be found
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


_ROUNDS = 3
"""Changes that a climb makes, one after the other. Our own choice."""
_CLIMB_STEPS = 16
"""Small steps that are looked at for each change. Our own choice: about as many as a scan of all variables has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climbs:
    """What several climbs have looked at."""

    values: Floats  #: all designs on the way, shape (n, d)
    #: costs, violation: what is expected of them, as ``Prediction.fine`` has it, shape (n, m) and (n,)
    costs: Floats
    violation: Floats
    ends: NDArray[np.intp]  #: rows of the designs at which the climbs ended, shape (number of climbs,)


def climbs(
    space: Space, start: Floats, prediction: Prediction, standing: Standing, generator: np.random.Generator
) -> Climbs:
    """Climb from each of s designs, shape (s, d), to where the model expects more and more gain over the front.

    Each change is the best of single variables elsewhere and of small steps of several, or none. A climb ends in one
    generation where evolution arrives after many, or never, since it drops designs that do not yet gain.
    """
    count, dimensions = start.shape
    best, every, looked_at = start, np.arange(count), 0
    rounds: list[tuple[Floats, Floats, Floats]] = []
    for _ in range(_ROUNDS):
        near = (scans(space, best, generator), small_steps(space, best, _CLIMB_STEPS, generator), best)
        around = np.concatenate([part.reshape(count, -1, dimensions) for part in near], axis=1)
        values = around.reshape(-1, dimensions)
        costs, violation = prediction.fine(values)
        most = gains(costs, violation, standing).reshape(count, -1).argmax(axis=1)
        best, ends = around[every, most], looked_at + every * around.shape[1] + most
        rounds.append((values, costs, violation))
        looked_at += len(values)
    values, costs, violation = (np.concatenate(column) for column in zip(*rounds, strict=True))
    return Climbs(values=values, costs=costs, violation=violation, ends=ends)


_MOTOR_ENDS_STEPS = 60
"""Small steps that are looked at for each change. Our own choice: with 16, a motor with few designs is not learned."""


def ends_of_least_tried(
    features: Features,
    archive: Archive,
    standing: Standing,
    prediction: Prediction,
    generator: np.random.Generator,
) -> Iterator[Floats]:
    """Yield per objective new designs, shape (n, d), of the motor that has the fewest, the most promising first.

    The model knows little of a motor with few designs, and by what it knows, the heaviest motor, which alone jumps
    highest, never comes near the front. Without these designs, five searches over the six motors had 94.6 to 99.7
    percent of the hypervolume of four motors' fronts after 4,000 jumps, with them 99.7 in each.

    From the best design so far, each change goes to the best of all that are looked at, also if it promises less,
    because a climb that stays looks at nothing new. For the same reason, distance from all known designs counts.
    """
    space = archive.space
    column, motor = _least_tried(space, archive.values, standing)
    known = standing.order[archive.values[standing.order, column] == motor]
    holds = known[(archive.constraints[known] <= 0.0).all(axis=1)]
    known = holds if len(holds) else known[:1]
    for objective in range(standing.costs.shape[1]):
        best = archive.values[known[standing.costs[known, objective].argmin()]][None]
        designs, promise = [], []
        for _ in range(_ROUNDS):
            near = np.vstack((scans(space, best, generator), small_steps(space, best, _MOTOR_ENDS_STEPS, generator)))
            near = near[near[:, column] == motor]
            costs, violation = prediction.fine(near)
            designs.append(near)
            away = cdist(features.scaled(near), archive.points).min(axis=1)
            worth = -standing.scaled(costs)[:, objective] - PENALTY * violation
            promise.append(worth + CURIOSITY * away)
            best = near[promise[-1].argmax()][None]
        yield np.vstack(designs)[np.argsort(-np.concatenate(promise), kind="stable")]


def _least_tried(space: Space, values: Floats, standing: Standing) -> tuple[int, int]:
    """Return the column of a choice, and the motor there that the fewest designs have of those that jumped at all."""
    tried: list[tuple[int, int, int]] = []
    for column, choice in zip(space.choice_columns, space.choices, strict=True):
        for motor in range(len(choice.motors)):
            chosen: NDArray[np.bool_] = values[:, column] == motor
            if chosen[standing.order].any():
                tried.append((int(np.count_nonzero(chosen)), column, motor))
    _, column, motor = min(tried)
    return column, motor


_REFINED = 3
"""Offspring per simulated design that are refined by small steps. Our own choice."""
_STEPS = 4
"""Small steps that are tried from each of them. Our own choice."""

_ON_BOUND = (0.25, 0.45)
"""Share of a variable's values on either bound in a quarter of the first designs and in the next quarter, and in either
half of those anywhere. Our own choice: many of the best designs have most of their variables on bounds, some of them in
a corner far from all others, and polynomials are determined best by points there."""
_ANYWHERE = 1000
"""Designs anywhere in the space from which explorers are chosen and climbs begin. Our own choice."""
_EXPLORING = 0.1
"""Share of what the model chooses that explores, half of it where no explorer holds the limits. Our own choice: without
it, some searches miss a part of the front that lies far from the rest in the space. Where explorers had to promise a
gain, too, 9 of 20 searches of Case C found the hip's jumps at 1.08 m with 2,000 designs; now 16 do."""
_SEEKING = 0.5
"""The same as long as no design holds the limits. Our own choice: the least violation near by may be that of the wrong
gearboxes."""

_PLAIN_ENDS = (0.1, 0.95)
"""Least and greatest share of plain evolution, which the model does not rank. Our own choice: each side keeps a few
designs, or what it gains is not seen."""
_REMEMBERED = 0.8
"""Weight of all earlier generations in it, against 1 of the last: it follows about the last five. Our own choice."""
_HELD = 0.7
"""Share of what the model chooses that holds the limits, below which half as much is tolerated next time, above which
twice as much. Our own choice: near what is left beside explorers, of which few hold tight limits."""
_CLIMBS = 6
"""Climbs that begin anywhere; as many begin on the front, and half as many close to it. Our own choice."""
_CLOSE = 1000
"""Designs nearest the front that climbs begin at. Our own choice: a few times as many as the front has."""

_OF_A_MOTOR = 2
"""Designs of the least tried motor per generation and objective. Our own choice, see ``ends_of_least_tried``."""

_SMALLER = (2, 4)
"""What a population is divided by while a Gaussian process predicts, and later as long as no design holds the limits.
Our own choice: the model errs most then, and learns from every generation."""

_FEW = 50
"""Generations of the population's own size. Our own choice: 2,000 designs with the default population."""
_LARGER = 2
"""How many times as many designs each later generation has, and as many climbs. Our own choice: the model takes as long
for twice as many designs, and the front is as good. Four times as many, with no more climbs, take a tenth less time for
8,000 designs of Case C, but one of 15 seeds then needs 1.2 percent more energy than the best known at 1.1 m, where all
15 are within 0.3 percent with twice as many."""


def _unranked(values: Floats, missing: NDArray[np.bool_], count: int, generator: np.random.Generator) -> Floats:
    """Choose ``count`` of n offspring at random, of those that are not expected to miss a limit if there are enough."""
    order = generator.permutation(len(values))
    return values[order[np.argsort(missing[order], kind="stable")[:count]]]


class SurrogateSearch(Algorithm):
    """Evolves designs, and simulates the most promising of many offspring.

    The first generations are spread over the space, half of them over its bounds and corners, too. Later generations
    vary the designs on the front and predict the offspring's scores (``Prediction``). The most promising are varied
    again in small steps, and, once the model has a design for each of its terms, some climb (``climbs``): from
    anywhere, from the front, its ends first, and close to it. Of all these, the search asks for those that gain most
    over the front, the best of each part of it first; without a front, for those that miss the limits least and are
    unlike each other. Some explore far from all simulated designs, where limits are expected to hold, whatever gain is
    expected there. A share is plain evolution, the greater, the more that gains beside what the model chooses. Where
    motors are chosen, the motor with the fewest designs gets some at the ends of its own front
    (``ends_of_least_tried``).

    Every generation has its own random generator, whose seed follows from the study's. The simulated designs and a few
    numbers are therefore the whole state, and a search rebuilt from them, also with a larger budget, continues bit for
    bit.
    """

    def __init__(self, space: Space, settings: SurrogateSettings, seed: int) -> None:
        self._space = space
        self._settings = settings
        self._seed = seed
        self._generation = 0
        self._seen = Seen()
        self._archive = Archive(space)
        self._standing = self._archive.standing()
        self._features: Features = features_of(space)
        self._asked = np.zeros((0, len(space.names)))
        # explorers, and designs of plain evolution: the last of those asked for
        self._explorers, self._plain = 0, 0
        self._held = 1.0  # share of the last explorers that hold the limits
        self._gains = np.ones(2)  # of the model's designs and of plain ones, as shares of both
        self._tolerated = TOLERATED
        self._drawing = True  # whether designs are still spread over the space

    @property
    def _times(self) -> int:
        """How many times the population the next generation has."""
        return 1 if self._generation < _FEW else _LARGER

    @property
    def _plain_share(self) -> float:
        """Share of the next generation that is plain evolution; it follows the square of what either side gains."""
        model, plain = self._gains**2
        return float(min(max(plain / (model + plain), _PLAIN_ENDS[0]), _PLAIN_ENDS[1]))

    @property
    def _size(self) -> int:
        """Designs of the next generation."""
        if self._drawing:
            return self._settings.population
        if self._archive.few:
            return max(1, self._settings.population // _SMALLER[0])
        if len(self._standing.front):
            return self._settings.population * self._times
        return max(1, self._settings.population // _SMALLER[1])

    def ask(self) -> Proposal | None:
        """Return designs spread over the space, later the most promising offspring; None if there is no new design."""
        generator = np.random.default_rng([self._seed, self._generation])
        standing = self._standing = self._archive.standing(self._tolerated)
        if self._generation == self._settings.drawn_generations or (self._generation and len(standing.front) == 0):
            self._drawing = False  # where no drawn design holds the limits, drawing more rarely finds one
        self._plain, self._explorers, size = 0, 0, self._size
        if self._generation == 0 and self._space.begin is not None:
            chosen = self._space.begin()[:size]
        elif self._drawing or len(standing.order) == 0:
            corners = (size - size // 2) // 2
            counts = (size // 2, size - size // 2 - corners, corners)
            parts = zip(counts, (0.0, *_ON_BOUND), strict=True)
            chosen = np.vstack([spread(self._space, count, generator, share) for count, share in parts])
        else:
            chosen = self._promising(standing, generator)
        new = self._seen.new(chosen)
        self._plain = int(np.count_nonzero(new[len(new) - self._plain :]))
        chosen = chosen[new]
        if len(chosen) == 0:
            chosen = drawn(self._space, self._seen, generator, size)
        self._asked = chosen
        return Proposal(values=chosen) if len(chosen) else None

    def tell(self, scores: Scores) -> None:
        """Add the designs to what the model is fitted to; compare what model and plain evolution gained."""
        by_model = len(self._asked) - self._plain
        if self._plain and by_model:
            model = self._archive.gained(scores.of(slice(by_model))) / by_model
            plain = self._archive.gained(scores.of(slice(by_model, None))) / self._plain
            both = model + plain
            self._gains = _REMEMBERED * self._gains + (np.array((model, plain)) / both if both > 0.0 else 0.5)
            if len(self._standing.front):
                explored = scores.violation[max(by_model - self._explorers, 0) : by_model]
                if self._explorers:
                    self._held += (1.0 - _REMEMBERED) * (float(np.mean(explored == 0.0)) - self._held)
                held = float(np.mean(scores.violation[:by_model] == 0.0))
                self._tolerated = min(self._tolerated * (2.0 if held > _HELD else 0.5), TOLERATED)
        self._add(self._asked, scores)
        self._generation += 1

    def state(self) -> dict[str, Any]:
        """Return all but the designs, which are in the database."""
        return {
            "generation": self._generation,
            "gains": self._gains.tolist(),
            "held": self._held,
            "tolerated": self._tolerated,
            "drawing": self._drawing,
        }

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Add the designs of the history."""
        for values, scores in history:
            self._add(values, scores)
        self._generation = int(state["generation"])
        # Earlier versions stored less.
        self._gains = np.array(state.get("gains", self._gains), dtype=np.float64)
        self._held = float(state.get("held", self._held))
        self._tolerated = float(state.get("tolerated", TOLERATED))
        self._drawing = bool(state.get("drawing", self._generation < self._settings.drawn_generations))

    def _add(self, values: Floats, scores: Scores) -> None:
        self._seen.add(values)
        self._archive.add(values, scores)

    def _promising(self, standing: Standing, generator: np.random.Generator) -> Floats:
        """Choose the most promising of many new designs; all of them if they are no more than a generation has."""
        values = offspring(self._archive, standing, self._settings, generator)
        values = values[self._seen.new(values)]
        if len(values) <= self._size:
            return values
        with one_thread():
            prediction = Prediction(self._archive, standing, self._features)
            return self._most_promising(values, prediction, standing, generator)

    def _most_promising(
        self, values: Floats, prediction: Prediction, standing: Standing, generator: np.random.Generator
    ) -> Floats:
        """Choose a generation from offspring, shape (n, d), small steps around the best, and climbs.

        Explorers come behind these, plain evolution last.
        """
        size, roughly = self._size, prediction.rough(values)
        plain = _unranked(values, roughly[1] > standing.tolerated, round(self._plain_share * size), generator)
        best = values[ranked(*roughly, standing)[: _REFINED * size]]
        values = np.vstack((best, small_steps(self._space, best, _STEPS, generator)))
        values = values[self._seen.new(values)]
        costs, violation = prediction.fine(values)
        exploring = 0.5 * (1.0 + self._held) * _EXPLORING if len(standing.front) else _SEEKING
        explorers, count = values[:0], round(exploring * (size - len(plain)))
        known = self._archive.points
        anywhere = np.vstack([spread(self._space, _ANYWHERE // 2, generator, share) for share in _ON_BOUND[::-1]])
        expected = prediction.hoped(anywhere)
        if prediction.determined or len(standing.front) == 0:
            start = self._starts(anywhere[ranked(*expected, standing)], standing, generator)
            climbed = climbs(self._space, start, prediction, standing, generator)
            values, costs = np.vstack((values, climbed.values)), np.vstack((costs, climbed.costs))
            violation = np.concatenate((violation, climbed.violation))
            ends = climbed.ends
            worth = gains(climbed.costs[ends], climbed.violation[ends], standing)
            explorers = self._afar(climbed.values[ends], worth, known, count // 2)
            known = np.vstack((known, self._features.scaled(explorers)))
        if self._space.choices and len(standing.front):
            motors = ends_of_least_tried(self._features, self._archive, standing, prediction, generator)
            firsts = np.vstack([best[self._seen.new(best)][:_OF_A_MOTOR] for best in motors])
            explorers = np.vstack((explorers, firsts[: size // 4]))
        # Beside a front, others need only hold the limits: where the model knows nothing, it promises nothing.
        worth = -PENALTY * expected[1] if len(standing.front) else gains(*expected, standing)
        others = self._afar(anywhere, worth, known, max(count - len(explorers), 0))
        # A climb from anywhere may have ended where it began, or where plain evolution leads.
        others = np.vstack((explorers, others, plain))
        new = self._seen.new(np.vstack((others, values)))
        fresh = new[len(others) :]
        values, costs, violation = values[fresh], costs[fresh], violation[fresh]
        self._plain, self._explorers = len(plain), len(others) - len(plain)
        left = max(size - len(others), 0)
        if len(standing.front):
            return np.vstack((values[ranked(costs, violation, standing)[:left]], others))
        known = np.vstack((self._archive.points, self._features.scaled(others)))
        # Distance counts the less, the nearer a design has come to the limits.
        least = min(float(standing.behind.min()), 1.0)
        worth = gains(costs, violation, standing)
        return np.vstack((self._afar(values, worth, known, left, least), others))

    def _starts(self, promising: Floats, standing: Standing, generator: np.random.Generator) -> Floats:
        """Return designs that climbs begin at: promising ones anywhere, of the front, and close behind it.

        The front's ends are always among them: little of the rest of a generation is spent there.
        """
        count = self._times * _CLIMBS
        ends = standing.front[standing.posts[: standing.costs.shape[1]]]
        front = np.concatenate((ends, generator.permutation(standing.front)))[:count]
        close = generator.permutation(standing.order[:_CLOSE])[: count // 2]
        return np.vstack((promising[:count], self._archive.values[front], self._archive.values[close]))

    def _afar(self, values: Floats, worth: Floats, known: Floats, count: int, curiosity: float = CURIOSITY) -> Floats:
        """Choose ``count`` of n designs, shape (n, d), that are worth much and far from points that are known."""
        new = self._seen.new(values)
        values, worth = values[new], worth[new]
        return values[unlike(worth, self._features.scaled(values), known, count, curiosity)]
