"""Runs the tests of this folder; without pytest they are skipped, and that is said."""

import pathlib
import sys

try:
    import pytest
except ImportError:
    print("python.package: skipped, pytest is missing (Debian: python3-pytest)")
    sys.exit(77)

folder = str(pathlib.Path(__file__).parent)
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", folder, *sys.argv[1:]]))
