"""What each idea in mapping adds: films of ISR-Bench, mapping only, one setting at a time.

python -m experiments.ablation --out out/ablation
"""
