"""Tests of the front end and its parts, from video input to packer."""
