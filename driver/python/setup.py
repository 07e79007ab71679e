# SPDX-License-Identifier: Apache-2.0
"""Compiles the driver and its client library into the package; pyproject.toml has the rest."""

from setuptools import setup

setup(cffi_modules=["build_driver.py:builder"])
