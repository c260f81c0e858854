"""What calling from Python costs: import, one speed, and exponents in a loop of 10 000 speeds, beside C++. CPU time of one thread,
which other programs disturb little.

    python3 call_times.py CALL_TIMES_PROGRAM SCENE
"""

import json
import subprocess
import sys
import time

import hb

ROUNDS = 30


def shortest(rounds, calls, call):
    best = float("inf")
    for _ in range(rounds):
        start = time.process_time()
        for k in range(calls):
            call(k)
        best = min(best, (time.process_time() - start) / calls)
    return best


program, file = sys.argv[1:]
imports = {}
for name, code in {"hb": "import hb", "numpy": "import numpy", "hb and numpy": "import hb, numpy"}.items():
    timed = f"import time; t = time.process_time(); {code}; print(time.process_time() - t)"
    imports[name] = min(float(subprocess.run([sys.executable, "-c", timed], stdout=subprocess.PIPE, check=True).stdout) for _ in range(10))

m = hb.load(file)
x = hb.HillSystem(mass=1, damping=0.1, stiffness={0: 1.2, 1: 0.4})
cpp = json.loads(subprocess.run([program, file, str(ROUNDS)], stdout=subprocess.PIPE, check=True).stdout)
steady = shortest(ROUNDS, 20, lambda k: m.steady(omega=1.0, only="steady"))
speeds = [0.5 + 3.0 * k / 10000 for k in range(10000)]


def loop(_):
    for omega in speeds:
        x.stability(omega=omega)


stability = shortest(ROUNDS // 10, 1, loop) / len(speeds)

for name, seconds in imports.items():
    print(f"import {name:<14} {1e3 * seconds:8.1f} ms")
print(f"steady: C++ {1e6 * cpp['steady']:.1f} us, Python {1e6 * steady:.1f} us, overhead {1e6 * (steady - cpp['steady']):.1f} us")
print(
    f"stability, 10 000 speeds: C++ {1e6 * cpp['stability']:.2f} us, Python {1e6 * stability:.2f} us each, "
    f"{stability / cpp['stability']:.2f} times"
)
