"""A child that hangs in mutant 2, dies in 4 and reads 6 wrongly, for the test of the harness."""

import json
import os
import sys

_, _, _, first, end = sys.argv
for number in range(int(first), int(end)):
    sys.stdout.write(f"{number}\n")
    sys.stdout.flush()
    while number == 2:
        pass
    if number == 4:
        os.abort()
    sys.stdout.write(json.dumps("other numbers: 3 entries differ" if number == 6 else "refused") + "\n")
    sys.stdout.flush()
