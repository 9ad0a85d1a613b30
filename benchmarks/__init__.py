"""Benchmarks: how long things take here, beside a peer in the same run and a bound."""
