"""Studies: the study file, the search algorithms behind one ask-and-tell face, the run loop, storage and resume."""
