# SPDX-License-Identifier: Apache-2.0
"""Which files the wheel holds; everything else about the package is in `pyproject.toml`.

Written here because pyproject.toml can either search for packages or list them all, and `rtl/` becomes the package
`sim.rtl` although it lies elsewhere.
"""

from setuptools import find_packages, setup

NO_TESTS = ["*.tests", "*.tests.*"]

setup(
    packages=[
        *find_packages("sw", include=["signum", "signum.*"], exclude=NO_TESTS),
        *find_packages(include=["golden", "golden.*", "sim", "sim.*"], exclude=NO_TESTS),
        "sim.rtl",
    ],
    package_dir={"signum": "sw/signum", "sim.rtl": "rtl"},
    package_data={
        "signum": ["py.typed"],
        "golden": ["py.typed"],
        "golden.compiled": ["*.[ch]pp"],
        "sim": ["py.typed"],
        "sim.rtl": ["*.*", "**/*.*"],
        "sim.board": ["*.[ch]pp"],
        "sim.lint": ["verible.*"],
        "sim.registers.gen": ["*.db", "*.h", "*.pyi"],
        "sim.mutate": ["*.toml", "*.sv", "*.cpp"],
        "sim.synth": ["*.sv", "floorplans/*.json"],
        "sim.testbench": ["*.cpp", "tb/*.sv", "tb/signs/*.hex"],
    },
)
