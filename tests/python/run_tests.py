"""Runs the tests of this folder, or of the files named; without pytest they are skipped, and that is said."""

import pathlib
import sys

try:
    import pytest
except ImportError:
    print("python.package: skipped, pytest is missing (Debian: python3-pytest)")
    sys.exit(77)

folder = pathlib.Path(__file__).parent
named = [str(folder / file) for file in sys.argv[1:] if file.endswith(".py")]
flags = [word for word in sys.argv[1:] if not word.endswith(".py")]
sys.exit(pytest.main(["-q", "-p", "no:cacheprovider", *(named or [str(folder)]), *flags]))
