"""The model of few designs against another library's, and against the polynomial that follows it."""

import numpy as np
import pytest
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern

from pareto_monoped.search.prediction import Prediction
from pareto_monoped.search.response_surface import GaussianProcess, features_of
from pareto_monoped.search.variation import spread
from tests.search.test_surrogate import SPACE, archive_of, scored


def test_the_gaussian_process_is_that_of_another_library():
    """Scikit-learn's with the same kernel: its mean, deviation, and a likelihood that is greatest where ours fits."""
    generator = np.random.default_rng(5)
    points, new = generator.uniform(-1.0, 1.0, (60, 3)), generator.uniform(-1.0, 1.0, (200, 3))
    curve = 10.0 + 3.0 * np.sin(2.0 * points[:, 0]) + points[:, 1]
    targets = np.column_stack((curve, np.exp(points).sum(axis=1))) + generator.normal(0.0, 0.2, (60, 2))
    ours = GaussianProcess(points, targets)

    def theirs(fit, column):
        kernel, nugget = Matern(length_scale=np.exp(fit[:-1]), nu=2.5), np.exp(fit[-1])
        known = (targets[:, column] - targets[:, column].mean()) / targets[:, column].std()
        once = GaussianProcessRegressor(kernel, alpha=nugget, optimizer=None).fit(points, known)
        variance = known @ once.alpha_ / len(known)
        scaled = GaussianProcessRegressor(ConstantKernel(variance) * kernel, alpha=nugget * variance, optimizer=None)
        return scaled.fit(points, known)

    for column in range(2):
        mean, deviation = theirs(ours.fit, column).predict(new, return_std=True)
        spread_out = targets[:, column].std()
        np.testing.assert_allclose(
            ours.mean(new)[:, column], mean * spread_out + targets[:, column].mean(), atol=1e-6 * spread_out
        )
        np.testing.assert_allclose(ours.deviation(new)[:, column], deviation * spread_out, atol=1e-6 * spread_out)

    def posterior(fit):
        likelihood = sum(theirs(fit, column).log_marginal_likelihood_value_ for column in range(2))
        return likelihood - 0.5 * float(((fit[:-1] - np.log(2.0)) ** 2).sum())

    for direction in np.eye(4):
        for step in (-0.05, 0.05):
            assert posterior(ours.fit + step * direction) < posterior(ours.fit)


def test_a_process_of_few_designs_predicts_closer_than_their_number_lets_a_cubic():
    """Noise-free measures of 60 designs, at 500 others: the cubic has 35 terms to fit to them."""
    archive, others = archive_of(60), spread(SPACE, 500, np.random.default_rng(9))
    standing = archive.standing()
    truth = np.column_stack((-np.log(scored(others).values[:, 0]), np.log(scored(others).values[:, 1])))
    process, _ = Prediction(archive, standing, features_of(SPACE)).fine(others)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pareto_monoped.search.archive._FEW_DESIGNS", 0)
        cubic, _ = Prediction(archive, standing, features_of(SPACE)).fine(others)
    errors = [float(np.sqrt(np.mean((found - truth) ** 2))) for found in (process, cubic)]
    assert errors[0] < 0.5 * errors[1]
