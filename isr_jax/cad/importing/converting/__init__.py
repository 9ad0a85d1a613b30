"""From what a file says to a model of a library: pose, class, planes, masses, handles."""
