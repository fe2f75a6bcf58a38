"""The commands of `rttrr-pin`, one module each: they parse, call, and turn results into exit codes; no mathematics.

Exit codes: 0 agree (all right), 1 disagree (findings), 2 unusable input, 130 interrupted.
"""
