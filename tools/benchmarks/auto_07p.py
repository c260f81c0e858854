"""AUTO-07p on the forced Mathieu equation of results/mathieu: times of its compiled program alone, and its error.

Debian's package auto-07p and gfortran. Steps of 0.01 in the speed, Floquet multipliers at each, with several meshes; the error
is that of the 2-norm of q against the Fourier coefficients of `hb steady` at every 23rd speed (printed with ten digits)."""

import math
import os
import pathlib
import shutil
import subprocess
import tempfile

from whole_commands import Times, Run, document, root

AUTO = pathlib.Path("/usr/lib/auto-07p")
CONSTANTS = """parnames = {{1: 'Omega', 2: 'norm', 11: 'period'}}
NDIM = 4, IPS = 2, IRS = 0, ILP = 0, ISP = 2, IID = 2, IPLT = 0
ICP = ['Omega', 'period', 'norm']
NTST = {intervals}, NCOL = {points}, IAD = 3, JAC = 1, ISW = 1, MXBF = 0
EPSL = 1e-8, EPSU = 1e-8, EPSS = 1e-5, ITMX = 8, ITNW = 5, NWTN = 3
DS = 0.01, DSMIN = 0.01, DSMAX = 0.01, IADS = 0
NMX = {most}, NPR = 0, UZSTOP = {{'Omega': 4.0}}
THL = {{'Omega': 1, 'period': 0}}, THU = {{1: 0, 2: 0, 3: 0, 4: 0}}
"""
MESHES = ((10, 4), (20, 4), (20, 7))


def installed():
    return AUTO.exists() and shutil.which("gfortran") is not None


class Mathieu:
    """One mesh: `argv` runs it (in its own folder, which ends with this object)."""

    def __init__(self, intervals, points):
        self.name = f"AUTO-07p: NTST = {intervals}, NCOL = {points}"
        self.folder = tempfile.TemporaryDirectory()
        place = pathlib.Path(self.folder.name)
        (place / "fort.2").write_text(CONSTANTS.format(intervals=intervals, points=points, most=500))
        subprocess.run(["gfortran", "-O2", "-fopenmp", root / "tools" / "benchmarks" / "mathieu_auto.f90",
                        *sorted((AUTO / "lib").glob("*.o")), "-o", "mathieu"], cwd=place, check=True)
        self.argv = ["/usr/bin/env", "-C", place, "OMP_NUM_THREADS=1", "./mathieu"]

    def answers(self):
        """Omega and norm at each speed of the last run, the first left out, which AUTO-07p does not correct."""
        rows = []
        for line in open(pathlib.Path(self.folder.name) / "fort.7"):
            words = line.split()
            if words[0] not in ("0", "-0") and len(words) == 12:
                rows.append((float(words[4].replace("E", "e")), float(words[11].replace("E", "e"))))
        return rows[1:]

    def error(self, hb):
        worst = 0.0
        for omega, norm in self.answers()[::23]:
            d = document(Run([hb, "steady", "results/mathieu/scene.toml", "--omega", repr(omega), "--json", "--only", "steady"], keep=True).out)
            c = next(iter(d["rods"].values()))["q"]["fourier"][0]
            exact = math.sqrt(c[0][0] ** 2 + 2 * sum(x * x + y * y for x, y in c[1:]))
            worst = max(worst, abs(norm / exact - 1))
        return worst
