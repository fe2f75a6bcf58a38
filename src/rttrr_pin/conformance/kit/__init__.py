"""For the tests of others: checks for pytest, an assertion that says why, strategies of Hypothesis."""
