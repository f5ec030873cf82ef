"""Tests of the files that users of clusters copy."""
