"""What is computed from stored studies: alternatives, robustness, sensitivity, limits, verification."""
