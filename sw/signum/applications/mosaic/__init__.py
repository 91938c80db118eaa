"""Surveys: frames placed by all the edges measured between them.

`edges` are measured by `signum.measure.register`; `graph` places the frames by least squares over them; `survey`
decides which edges to try; the rest writes what comes of it.
"""
