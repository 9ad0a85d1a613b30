"""ISR-Bench: made rooms with complete truth, the pipeline run over them, every measure in a table.

python -m experiments.bench --rooms 10 --out out/bench
"""
