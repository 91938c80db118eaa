"""Surveys: frames placed by all the links measured between them.

`links` are measured by `signum.measure.register`; `graph` places the frames by least squares over them; `survey`
decides which links to try; the rest writes what comes of it.
"""
