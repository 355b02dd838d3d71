# Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
"""The module is built by CMake; the wheel is for this Python and this kind of machine all the same."""

from setuptools import Distribution, setup


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


setup(
    packages=["lamina"],
    package_data={"lamina": ["*.so", "*.pyi", "py.typed"]},
    distclass=BinaryDistribution,
    zip_safe=False,
)
