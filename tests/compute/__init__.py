"""Tests of the room compute."""
