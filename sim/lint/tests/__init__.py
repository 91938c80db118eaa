"""Tests of the file lists."""
