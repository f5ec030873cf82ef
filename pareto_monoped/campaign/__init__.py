"""A grid of studies: run side by side, continued as a whole, compared on one page."""
