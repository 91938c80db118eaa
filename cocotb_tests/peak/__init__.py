"""Tests of the peak unit and its parts."""
