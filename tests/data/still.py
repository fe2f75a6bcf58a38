"""A program that is asked in JSON lines and gives zeros."""

import json
import sys

for line in sys.stdin:
    print(json.dumps({"tau": [0.0] * len(json.loads(line)["a"])}), flush=True)
