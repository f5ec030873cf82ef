"""Pictures without a display: shaded views, sections and their legends."""
