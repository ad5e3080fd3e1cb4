"""The fault programme: what happens to a study is done to it on purpose, many times over, and counted.

Each module of faults has a tuple FAULTS. The tests inject each a few times; `make faults` does so many times and writes
the table of figures.
"""
