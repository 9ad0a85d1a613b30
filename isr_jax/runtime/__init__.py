"""What runs around the stages: stored results, folders of runs, progress, caches, threads."""
