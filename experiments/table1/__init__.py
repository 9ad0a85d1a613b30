"""Table I of the paper: panoptic mapping on SceneNN, ours beside what was published.

python -m experiments.table1 --scenenn DIR
"""
