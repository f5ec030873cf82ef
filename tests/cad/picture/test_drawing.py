"""Triangles cover the pixels and have the depths that linear algebra gives them."""

import numpy as np

from pareto_monoped.cad.picture.drawing import nearest


def test_the_nearest_triangle_is_seen_at_every_pixel():
    """Triangles that pierce each other, against barycentric coordinates of each pixel's centre in each triangle."""
    rng = np.random.default_rng(7)
    height, width, count = 24, 32, 12
    triangles = rng.uniform([-4.0, -4.0, -9.0], [width + 4.0, height + 4.0, 9.0], (count, 3, 3))
    winner, depth = np.full((height, width), count, dtype=np.int32), np.full((height, width), -np.inf)
    nearest(triangles, winner, depth)
    y, x = np.mgrid[:height, :width] + 0.5
    centres = np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
    shares = np.array([np.linalg.solve(np.vstack([t[:, :2].T, np.ones(3)]), centres) for t in triangles])
    within = shares.min(axis=1) >= 0.0
    z = np.where(within, np.einsum("tkp,tk->tp", shares, triangles[:, :, 2]), -np.inf)
    np.testing.assert_allclose(depth.ravel(), z.max(axis=0), rtol=1e-9, atol=1e-9)
    np.testing.assert_array_equal(winner.ravel(), np.where(within.any(axis=0), z.argmax(axis=0), count))
    assert len(np.unique(winner)) > 6
