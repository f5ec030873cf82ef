"""Surrogate-assisted search: many offspring, ranked by a cheap model; the most promising are simulated."""

from collections.abc import Iterable
from typing import Any

import numpy as np

from pareto_monoped.study.algorithm_settings import SurrogateSettings
from pareto_monoped.study.archive import Archive, Standing
from pareto_monoped.study.one_thread import one_thread
from pareto_monoped.study.prediction import Prediction
from pareto_monoped.study.promise import ranked, unlike
from pareto_monoped.study.protocol import Floats, Proposal, Scores, Space
from pareto_monoped.study.response_surface import Features, features_of
from pareto_monoped.study.seen import Seen, drawn
from pareto_monoped.study.variation import offspring, small_steps, spread, swaps

_REFINED = 5
"""Offspring per simulated design that are refined by small steps. Our own choice."""
_STEPS = 4
"""Small steps that are tried from each of them. Our own choice."""

_SWAPPED = 6
"""Designs of the front whose gearboxes are each replaced by all others. Our own choice: a gearbox that gains a
millimetre is one of 40, which steps at random rarely try where the gain is."""

_ON_BOUND = 0.25
"""Share of a variable's values on either bound in half of the first designs and in explorers: many of the best designs
have variables on their bounds, and polynomials are determined best by points there. Our own choice."""
_ANYWHERE = 1000
"""Designs anywhere in the space from which explorers are chosen. Our own choice."""
_EXPLORING = 0.1
"""Share of a generation that explores. Our own choice: without it, some searches miss a part of the front that lies
far from the rest in the space."""


class SurrogateSearch:
    """Evolution that simulates the most promising of many offspring.

    The first generations are spread over the space, half of them over its bounds, too. Later, each generation varies
    the designs on the front so far and predicts objectives and constraints of the offspring (``Prediction``). The most
    promising are varied again, in steps from fine to coarse, and a few designs of the front get every other gearbox. Of
    all these, the search asks for those that gain most over the front, the best of each part of it first: the ends of
    the front are parts, too. A tenth of each generation explores: it is far from all simulated designs, and still
    promising.

    Every generation refines, so a search that gets a larger budget goes on as if it had had it from the beginning.
    Every generation has its own random generator, whose seed follows from the study's. The simulated designs are
    therefore the whole state, and a search rebuilt from them continues bit for bit.
    """

    def __init__(self, space: Space, settings: SurrogateSettings, seed: int) -> None:
        self._space = space
        self._settings = settings
        self._seed = seed
        self._generation = 0
        self._seen = Seen()
        self._archive = Archive(space)
        self._features: Features = features_of(space)
        self._asked = np.zeros((0, len(space.names)))

    def ask(self) -> Proposal | None:
        """Designs spread over the space, later the most promising offspring; None if there is no new design."""
        generator = np.random.default_rng([self._seed, self._generation])
        size = self._settings.population
        standing = self._archive.standing()
        if self._generation < self._settings.drawn_generations or len(standing.order) == 0:
            inside = spread(self._space, size // 2, generator)
            chosen = np.vstack((inside, spread(self._space, size - size // 2, generator, _ON_BOUND)))
        else:
            chosen = offspring(self._archive, standing, self._settings, generator)
        chosen = chosen[self._seen.new(chosen)]
        if len(chosen) > size:
            with one_thread():
                chosen = self._most_promising(chosen, standing, generator)
        if len(chosen) == 0:
            chosen = drawn(self._space, self._seen, generator, size)
        self._asked = chosen
        return Proposal(values=chosen) if len(chosen) else None

    def tell(self, scores: Scores) -> None:
        """Add the designs to what the model is fitted to."""
        self._add(self._asked, scores)
        self._generation += 1

    def state(self) -> dict[str, Any]:
        """The number of generations; the designs are in the database."""
        return {"generation": self._generation}

    def restore(self, state: dict[str, Any], history: Iterable[tuple[Floats, Scores]]) -> None:
        """Add the designs of the history."""
        for values, scores in history:
            self._add(values, scores)
        self._generation = int(state["generation"])

    def _add(self, values: Floats, scores: Scores) -> None:
        self._seen.add(values)
        self._archive.add(values, scores)

    def _most_promising(self, values: Floats, standing: Standing, generator: np.random.Generator) -> Floats:
        """As many designs as a generation has, from offspring, shape (n, d), small steps around the best, and afar."""
        size = self._settings.population
        prediction = Prediction(self._archive, standing, self._features)
        best = values[ranked(*prediction.rough(values), standing)[: _REFINED * size]]
        swapped = swaps(self._space, self._archive.values[generator.permutation(standing.front)[:_SWAPPED]])
        values = np.vstack((best, small_steps(self._space, best, _STEPS, generator), swapped))
        values = values[self._seen.new(values)]
        explorers = self._explorers(prediction, standing, generator)
        chosen = values[ranked(*prediction.fine(values), standing)[: size - len(explorers)]]
        chosen = np.vstack((chosen, explorers))
        return chosen[self._seen.new(chosen)]

    def _explorers(self, prediction: Prediction, standing: Standing, generator: np.random.Generator) -> Floats:
        """Promising designs far from all simulated ones, a tenth of a generation; none without a front."""
        count = round(_EXPLORING * self._settings.population)
        if count == 0 or len(standing.front) == 0:
            return self._archive.values[:0]
        anywhere = spread(self._space, _ANYWHERE, generator, _ON_BOUND)
        anywhere = anywhere[self._seen.new(anywhere)]
        points, known = self._features.scaled(anywhere), self._features.scaled(self._archive.values)
        return anywhere[unlike(*prediction.rough(anywhere), standing, points, known, count)]
