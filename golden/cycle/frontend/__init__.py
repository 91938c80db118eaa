"""Cycle models from the video input to packed sign bits: video in, LoG and its parts, packer."""
