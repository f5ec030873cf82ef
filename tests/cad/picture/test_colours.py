"""The palette's colours differ for everyone: recomputed from the published matrices of colour vision deficiency."""

import numpy as np
import pytest

from pareto_monoped.cad.picture.labels import LEAST_DISTANCE, LEAST_FOR_DEFICIENT, PALETTE, colour

# Machado, Oliveira and Fernandes 2009, table of severity 1.0, for linear RGB.
VISION = {
    "normal": np.eye(3),
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritanopia": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.072175], [0.0193339, 0.119192, 0.9503041]]
)


def linear(rgb):
    """IEC 61966-2-1."""
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    """CIELAB of linear sRGB, white D65 (ISO/CIE 11664-4)."""
    xyz = rgb @ TO_XYZ.T / TO_XYZ.sum(axis=1)
    f = np.where(xyz > (6.0 / 29.0) ** 3, np.cbrt(xyz), xyz / (3.0 * (6.0 / 29.0) ** 2) + 4.0 / 29.0)
    return np.stack([116.0 * f[:, 1] - 16.0, 500.0 * (f[:, 0] - f[:, 1]), 200.0 * (f[:, 1] - f[:, 2])], axis=1)


@pytest.mark.parametrize("vision", VISION)
def test_any_two_colours_can_be_told_apart(vision):
    seen = lab(np.clip(linear(np.array(PALETTE)) @ np.array(VISION[vision]).T, 0.0, 1.0))
    apart = np.linalg.norm(seen[:, None] - seen[None], axis=2)
    assert apart[~np.eye(len(seen), dtype=bool)].min() >= (
        LEAST_DISTANCE if vision == "normal" else LEAST_FOR_DEFICIENT
    )


def test_black_lines_and_white_paper_stand_out():
    lightness = lab(linear(np.array(PALETTE)))[:, 0]
    assert lightness.min() > 45.0
    assert lightness.max() < 96.0


def test_colours_repeat_after_the_last():
    assert colour(len(PALETTE)) == colour(0) != colour(1)


def test_colours_can_be_stored_in_bytes():
    levels = 255.0 * np.array(PALETTE)
    assert np.allclose(levels, np.round(levels))
    assert levels.min() >= 0.0
    assert levels.max() <= 255.0 + 1e-9
