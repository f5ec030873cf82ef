"""Measures that databases of earlier versions lack and that follow exactly from what they have."""

import numpy as np
import pandas as pd


def with_agility(trials: pd.DataFrame) -> pd.DataFrame:
    """The trials with ``agility_m_per_s`` wherever height and time of the apex are known.

    It is the same division as in ``jump.evaluate``, so a filled value equals a stored one to the last bit. The running
    hash is over what is stored: check it before.
    """
    stored = trials["agility_m_per_s"].to_numpy(dtype=np.float64)
    height, start, apex = (trials[name].to_numpy(dtype=np.float64) for name in ("height_m", "start_height_m", "apex_s"))
    missing = np.isnan(stored) & np.isfinite(height) & (apex > 0.0)
    if not missing.any():
        return trials
    filled = stored.copy()
    filled[missing] = (height[missing] - start[missing]) / apex[missing]
    return trials.assign(agility_m_per_s=filled)
